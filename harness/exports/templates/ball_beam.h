/* The identified ball-and-beam model. See README.txt.
 * {{ model.sentence|line }}
 * From: {{ model.origin|line }} */
#ifndef BALL_BEAM_H
#define BALL_BEAM_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#define BB_MAX_STEPS 2048 /* of the integration between two rows */
{% if history %}
#define BB_HISTORY 8192 /* rows that the mean over the last interval may reach back */
{% endif %}

/* Motion of the beam: angle [rad], its rate [rad/s], its angular acceleration [rad/s^2]. */
typedef struct {
  double angle, rate, angular;
} bb_beam;

/* The ball, what follows the measured angle, and the sensor, at a row. */
typedef struct {
  double time;     /* of the row [s] */
  bb_beam beam;    /* as measured, at the row */
  double s, v;     /* position [m] and velocity [m/s] of the ball */
  double w;        /* slip velocity [m/s], or pull of a Dahl friction [m/s^2]; else 0 */
  double sensed;   /* position behind the sensor's lag [m] */
  double origin;   /* position at which the rolled angle is `phase` [m] */
  double phase;    /* [rad] */
  double begin;    /* time of the first row [s] */
  int rows;        /* steps made */
{% for stage in stages if stage.kind == "lag" %}
  double follow_{{ stage.number }};  /* the lagging angle [rad] */
{% endfor %}
{% for stage in stages if stage.kind == "servo" %}
  double follow_{{ stage.number }}, follow_rate_{{ stage.number }};  /* angle and rate behind the servo [rad, rad/s] */
{% endfor %}
{% for stage in stages if stage.kind == "play" %}
  double stand_{{ stage.number }};   /* the beam's angle behind the play [rad] */
  double side_{{ stage.number }};    /* side of the gap in contact, 0 for none */
  long looked_{{ stage.number }};    /* instants looked at */
{% endfor %}
{% for stage in stages if stage.kind == "hold" %}
  double past_time_{{ stage.number }}[BB_HISTORY], past_sum_{{ stage.number }}[BB_HISTORY];
  bb_beam past_{{ stage.number }}[BB_HISTORY];
{% endfor %}
} bb_state;

/* Begin at a row: time [s], position [m], velocity [m/s], beam, phase [rad] (matters where a law depends on the rolled
 * angle only). */
void bb_start(bb_state *x, double time, double s, double v, bb_beam beam, double phase);

/* Go on to the next row. Returns 0; 1 if the time does not increase, 2 if rows lie too far apart{% if history %}, 3 if the history
 * is too short{% endif %}: x is unchanged then. */
int bb_step(bb_state *x, double time, bb_beam beam);

/* What the sensor records of the ball at the row [m], without its delay. */
double bb_recorded(const bb_state *x);

/* The delay of the sensor [s]: the position at t is recorded at t + delay. */
double bb_delay(void);

/* s'' [m/s^2] without dry friction, eq. 14 with the effects found. phi: the rolled angle [rad]; t: time [s]. */
double bb_acceleration(double s, double v, double angle, double rate, double angular, double phi, double t);

/* Largest deceleration that dry friction holds up against motion towards + or - [m/s^2]. */
double bb_dry_limit(double s, double v, double towards, double angle, double rate, double angular, double phi, double t);

/* Angle-only rows: rate and acceleration by a local cubic, fitted by least squares to the rows within `half` seconds
 * (at least the 7 nearest rows); the angle is smoothed by it too. It looks ahead, so it needs the whole record. */
void bb_derive(const double *time, const double *angle, size_t n, double half, bb_beam *out);

/* y at time `asked`, of n >= 1 values at increasing times: a cubic with the slopes of parabolas through neighbours, constant
 * beyond the ends. */
double bb_at(const double *time, const double *y, size_t n, double asked);

#ifdef __cplusplus
}
#endif
#endif
