/* The identified ball-and-beam model: the equation of motion (14) of the corrected angle model (CAM),
 *
 *   (1 + J/(m r^2)) s'' = g sin(alpha + alpha0) + s alpha'^2 - (h + r + J/(m r)) alpha'' + effects
 *
 * of Gembalczyk, Domogala, Lesniowski, Actuators 2023, 12(2), 59, doi 10.3390/act12020059. C99 and libm, nothing else.
 * Smooth forces: classical Runge-Kutta method. Dry friction: a set-valued force on the mean acceleration of a step. */
#include "ball_beam.h"

#include <math.h>

{% for one in constants %}
/* {{ one.told|line }} */
#define {{ one.name }} ({{ one.value|exact }})
{% endfor %}

#define K_ROLL (1.0 / (1.0 + INERTIA / (MASS * (ROLLING_RADIUS * ROLLING_RADIUS))))     /* 1/(1 + J/(m r^2)) */
#define LEVER ({{ lever }})     /* h + r + J/(m r) [m] */

typedef struct {
  double t;
  bb_beam beam;
} row_t;
{% if spline is not none %}

/* The law that no catalogue lists: a Catmull-Rom spline of {{ spline.depends.value }}{{ ', periodic' if spline.periodic }} [{{ spline.unit|line }}]. */
static const double NODES[] = { {%- for one in nodes %}{{ one|exact }}{{ ", " if not loop.last }}{% endfor -%} };
#define NODE_COUNT {{ nodes|length }}
#define NODE_LOW ({{ spline.low|exact }})
#define NODE_STEP ({{ spline.step|exact }})

static double spline(double at) {
  double place = (at - NODE_LOW) / NODE_STEP, before, here, there, after;
{% if spline.closed %}
  long node = (long)floor(place);
  double t = place - (double)node;
  long n = ((node % NODE_COUNT) + NODE_COUNT) % NODE_COUNT;
  before = NODES[(n + NODE_COUNT - 1) % NODE_COUNT];
  here = NODES[n];
  there = NODES[(n + 1) % NODE_COUNT];
  after = NODES[(n + 2) % NODE_COUNT];
{% else %}
  place = fmin(fmax(place, 0.0), NODE_COUNT - 1.0);
  int node = (int)place < NODE_COUNT - 2 ? (int)place : NODE_COUNT - 2;
  double t = place - node;
  here = NODES[node];
  there = NODES[node + 1];
  before = node > 0 ? NODES[node - 1] : 2.0 * here - there;
  after = node < NODE_COUNT - 2 ? NODES[node + 2] : 2.0 * there - here;
{% endif %}
  double low = 0.5 * (there - before), high = 0.5 * (after - here), rise = there - here;
  return here + t * (low + t * (3.0 * rise - 2.0 * low - high + t * (low + high - 2.0 * rise)));
}
{% endif %}

double bb_delay(void) { return SENSOR_DELAY; }

double bb_acceleration(double s, double v, double angle, double rate, double angular, double phi, double t) {
  double tilt = {{ tilt }};
  double result = K_ROLL * GRAVITY * sin(tilt) + K_ROLL * s * rate * rate - K_ROLL * LEVER * angular; /* eq. 14 */
{% if force %}
  result += K_ROLL * ({{ force }});
{% endif %}
  (void)v, (void)phi, (void)t;
  return result;
}

/* N/m = g cos(alpha) - 2 s' alpha' - s alpha'' - (h + r) alpha'^2 [m/s^2], never negative. */
static double normal_force(double s, double v, bb_beam b) {
  double normal = GRAVITY * cos(b.angle) - 2.0 * v * b.rate - s * b.angular - (ECCENTRICITY + ROLLING_RADIUS) * b.rate * b.rate;
  return fmax(normal, 0.0);
}

double bb_dry_limit(double s, double v, double towards, double angle, double rate, double angular, double phi, double t) {
  bb_beam b = {angle, rate, angular};
  double coefficient = towards > 0.0 ? {{ plus }} : {{ minus }};
{% if spline is not none and spline.friction %}
{% if argument == "t" %}
  coefficient = fmax(coefficient, 0.0) + spline(t);
{% else %}
  coefficient += spline({{ argument }});
{% endif %}
{% endif %}
  (void)phi, (void)t;
  return K_ROLL * fmax(coefficient, 0.0) * normal_force(s, v, b);
}

static double rolled(const bb_state *x, double s) { return (s - x->origin) / ROLLING_RADIUS + x->phase; }

static double accelerated(const bb_state *x, double s, double v, const row_t *at) {
  return bb_acceleration(s, v, at->beam.angle, at->beam.rate, at->beam.angular, rolled(x, s), at->t);
}
{% if dry %}

static double limit_of(const bb_state *x, double s, double v, double towards, const row_t *at) {
  return bb_dry_limit(s, v, towards, at->beam.angle, at->beam.rate, at->beam.angular, rolled(x, s), at->t);
}

/* After a step with dry friction, given the step without it: it opposes the motion, and holds a ball that stops. */
static void resist(const bb_state *x, double s, double v, double h, const row_t *mid, double *s_end, double *v_end) {
  double drive = (*v_end - v) / h, rest = h, sign, limit;
  if (v != 0.0) {
    sign = v > 0.0 ? 1.0 : -1.0;
    limit = limit_of(x, s, v, sign, mid);
{% if falling %}
    limit = limit_of(x, s, v + 0.5 * h * (drive - sign * limit), sign, mid);
{% endif %}
    *v_end -= sign * limit * h;
    if (sign * *v_end >= 0.0) {
      *s_end -= 0.5 * sign * limit * h * h;
      return;
    }
    double stop = v / (sign * limit - drive);
    s += 0.5 * v * stop;
    rest = h - stop;
  }
  sign = drive > 0.0 ? 1.0 : -1.0;
  limit = limit_of(x, s, 0.0, sign, mid);
  if (fabs(drive) <= limit) {
    *s_end = s;
    *v_end = 0.0;
  } else if (v == 0.0) {
    *s_end -= 0.5 * sign * limit * h * h;
    *v_end = (drive - sign * limit) * h;
  } else {
    *v_end = (drive - sign * limit) * rest;
    *s_end = s + 0.5 * *v_end * rest;
  }
}
{% endif %}
{% if slip %}

/* After a step of a ball that can slip; w is its slip velocity. Traction |F_t| <= mu N R/r.
   In pieces that end where the slip, or the turning, does. */
static void slide(bb_state *x, double s, double v, double h, const row_t *mid, double s_end, double v_end) {
  double iota = 1.0 / K_ROLL - 1.0, turn = ROLLING_RADIUS * mid->beam.angular, rolling = (v_end - v) / h;
  double free_ = (1.0 + iota) * rolling + iota * turn, both = 1.0 + 1.0 / iota, w = x->w, rest = h;
  double grip = {{ slip[0] }} * RADIUS / ROLLING_RADIUS * normal_force(s, v, mid->beam), plus = 0.0, minus = 0.0;
{% if dry %}
  resist(x, s, v, h, mid, &s_end, &v_end);
  plus = limit_of(x, s, v, 1.0, mid);
  minus = limit_of(x, s, v, -1.0, mid);
{% endif %}
  if (w == 0.0 && fabs((v_end - v) / h - free_) <= grip) {
    x->s = s_end;
    x->v = v_end;
    return;
  }
  for (int left = 8; left > 0; left--) {
    double spin = v - w, sense = spin > 0.0 || (spin == 0.0 && rolling > 0.0) ? 1.0 : -1.0;
    double held = sense > 0.0 ? plus : minus, resisted = sense * held / (K_ROLL * iota);
    if (spin == 0.0 && w == 0.0 && fabs(rolling) <= held) {
      v = 0.0;
      break;
    }
    double needed = -(free_ + turn + resisted) / both;
    int rolls = w == 0.0 && fabs(needed) <= grip, ends = 0, stops = 0;
    double traction = rolls ? needed : copysign(grip, w == 0.0 ? needed : -w);
    if (spin == 0.0 && !rolls) { /* a resistance holds a ball that does not turn, if it can */
      double pull = -(turn + traction / iota);
      resisted = copysign(fmin((pull > 0.0 ? plus : minus) / (K_ROLL * iota), fabs(pull)), pull);
    }
    double by_v = free_ + traction, by_w = rolls ? 0.0 : free_ + turn + resisted + traction * both;
    double by_spin = by_v - by_w, piece = rest;
    if (left > 1 && w * by_w < 0.0 && -w / by_w < piece) {
      piece = -w / by_w;
      ends = 1;
    }
    if (left > 1 && spin * by_spin < 0.0 && -spin / by_spin < piece) {
      piece = -spin / by_spin;
      ends = 0;
      stops = 1;
    }
    s += piece * (v + 0.5 * piece * by_v);
    v += piece * by_v;
    w = ends || rolls ? 0.0 : stops ? v : w + piece * by_w;
    if (stops && rolls) v = 0.0;
    rest -= piece;
    if (rest <= 0.0) break;
  }
  x->s = s;
  x->v = v;
  x->w = w;
}
{% endif %}
{% if dahl %}

/* Pull of a Dahl friction after h: dF/ds = -sigma (1 + F sign(s')/(c N)), solved exactly. */
static double dahl(double pull, double s, double v, double h, bb_beam b) {
  double limit = K_ROLL * {{ dahl[0] }} * normal_force(s, v, b), stiffness = K_ROLL * {{ dahl[1] }} / MASS;
  if (limit <= 0.0 || v == 0.0) return pull;
  double target = v > 0.0 ? -limit : limit;
  return target + (pull - target) * exp(-stiffness * fabs(v) * h / limit);
}
{% endif %}

/* The ball after one step of h; rows at its begin, middle and end. */
static void advance(bb_state *x, const row_t *rows) {
  const row_t *mid = rows + 1, *end = rows + 2;
  double h = end->t - rows->t, s = x->s, v = x->v;
{% if dahl %}
  x->w = dahl(x->w, s, v, 0.5 * h, rows->beam);
{% endif %}
{% if lost %}
  /* What dry friction takes of v in half the step: smooth forces of the velocity act on what is left. */
  double lost = v == 0.0 ? 0.0 : copysign(fmin(0.5 * h * limit_of(x, s, v, copysign(1.0, v), mid), fabs(v)), v);
  double u = v - lost;
{% set u, back_s, back_v = "u", " + h * lost", " + lost" %}
{% else %}
{% set u, back_s, back_v = "v", "", "" %}
{% endif %}
  double k1 = accelerated(x, s, {{ u }}, rows);
  double v2 = {{ u }} + 0.5 * h * k1, k2 = accelerated(x, s + 0.5 * h * {{ u }}, v2, mid);
  double v3 = {{ u }} + 0.5 * h * k2, k3 = accelerated(x, s + 0.5 * h * v2, v3, mid);
  double v4 = {{ u }} + h * k3, k4 = accelerated(x, s + h * v3, v4, end);
  double s_end = s + h * ({{ u }} + 2.0 * v2 + 2.0 * v3 + v4) / 6.0{{ back_s }};
  double v_end = {{ u }} + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0{{ back_v }};
{% if dahl %}
  s_end += 0.5 * h * h * x->w;
  v_end += h * x->w;
  x->w = dahl(x->w, s_end, v_end, 0.5 * h, end->beam);
{% endif %}
{% if slip %}
  slide(x, s, v, h, mid, s_end, v_end);
{% else %}
{% if dry %}
  resist(x, s, v, h, mid, &s_end, &v_end);
{% endif %}
  x->s = s_end;
  x->v = v_end;
{% endif %}
  if (SENSOR_LAG > 0.0) { /* exact for a position that goes linearly */
    double slope = (x->s - s) / h, follow = s - slope * SENSOR_LAG;
    x->sensed = follow + slope * h + (x->sensed - follow) * exp(-h / SENSOR_LAG);
  } else {
    x->sensed = x->s;
  }
}

/* Coefficients of the quintic through two motions h apart, lowest power first. */
static void quintic(bb_beam a, bb_beam b, double h, double c[6]) {
  double dp = b.angle - a.angle - a.rate * h - 0.5 * a.angular * h * h;
  double dv = b.rate - a.rate - a.angular * h, da = b.angular - a.angular;
  c[0] = a.angle, c[1] = a.rate, c[2] = 0.5 * a.angular;
  c[3] = (10.0 * dp - 4.0 * dv * h + 0.5 * da * h * h) / (h * h * h);
  c[4] = (-15.0 * dp + 7.0 * dv * h - da * h * h) / (h * h * h * h);
  c[5] = (6.0 * dp - 3.0 * dv * h + 0.5 * da * h * h) / (h * h * h * h * h);
}

static bb_beam along(const double c[6], double u) {
  bb_beam b = {0.0, 0.0, 0.0};
  for (int power = 5; power >= 0; power--) {
    b.angular = b.angular * u + 2.0 * b.rate;
    b.rate = b.rate * u + b.angle;
    b.angle = b.angle * u + c[power];
  }
  return b;
}
{% for stage in stages %}
{% set n = stage.number %}
{% if stage.kind in ("lag", "servo") %}

/* What a lag of a quintic settles to at u, a sum over its derivatives: of a lag, or servo, q b'' + T b' + b = a. */
static double settled_{{ n }}(const double c[6], double u) {
  const double T = {{ stage.names[0] }}, q = {{ stage.square }};
  double d[6], sum = 0.0, before = 0.0, factor = 1.0;
  for (int i = 0; i < 6; i++) d[i] = c[i];
  for (int order = 0; order < 6; order++) {
    double value = 0.0;
    for (int power = 5 - order; power >= 0; power--) value = value * u + d[power];
    sum += factor * value;
    double next = -T * factor - q * before;
    before = factor, factor = next;
    for (int power = 0; power < 5 - order; power++) d[power] = (power + 1) * d[power + 1];
  }
  return sum;
}
{% if stage.kind == "servo" %}

/* The same of its rate. */
static double settled_rate_{{ n }}(const double c[6], double u) {
  double d[6] = {c[1], 2.0 * c[2], 3.0 * c[3], 4.0 * c[4], 5.0 * c[5], 0.0};
  return settled_{{ n }}(d, u);
}

/* Value and rate, both at first, of q y'' + T y' + y = 0 after u. */
static void swung_{{ n }}(double *value, double *rate, double u) {
  const double T = {{ stage.names[0] }}, q = {{ stage.square }}, decay = 0.5 * T / q;
  double apart = decay * decay - 1.0 / q, turn = sqrt(fabs(apart)), x = turn * u, fading = exp(-decay * u);
  double even = fading * (1.0 + 0.5 * copysign(x * x, apart)), odd = fading * u * (1.0 + copysign(x * x, apart) / 6.0);
  if (x >= 1e-3 && apart < 0.0) {
    even = fading * cos(x), odd = fading * sin(x) / turn;
  } else if (x >= 1e-3) {
    double slow = exp(-u / (q * (decay + turn))), fast = exp(-(decay + turn) * u);
    even = 0.5 * (slow + fast), odd = 0.5 * (slow - fast) / turn;
  }
  double y = *value, v = *rate;
  *value = y * even + (v + decay * y) * odd;
  *rate = v * even - (y / q + decay * v) * odd;
}
{% endif %}
{% elif stage.kind == "hold" %}

/* Integral of the angle, angle and rate at time t, which may lie before the first row. */
static double past_{{ n }}(const bb_state *x, double t, bb_beam *b, const double c[6], double from, double sum) {
  double first = x->past_time_{{ n }}[0];
  int last = x->rows % BB_HISTORY;
  if (x->rows >= BB_HISTORY) first = -HUGE_VAL;
  if (t < first) {
    bb_beam a = x->past_{{ n }}[0];
    double early = t - first;
    b->angle = a.angle + a.rate * early, b->rate = a.rate, b->angular = 0.0;
    return early * (a.angle + 0.5 * a.rate * early);
  }
  double piece[6];
  if (t < from) {
    int i = last, back = x->rows < BB_HISTORY ? x->rows : BB_HISTORY - 1;
    while (back > 0 && x->past_time_{{ n }}[i] > t) i = (i + BB_HISTORY - 1) % BB_HISTORY, back--;
    int next = (i + 1) % BB_HISTORY;
    from = x->past_time_{{ n }}[i], sum = x->past_sum_{{ n }}[i];
    quintic(x->past_{{ n }}[i], x->past_{{ n }}[next], x->past_time_{{ n }}[next] - from, piece);
    c = piece;
  }
  double u = t - from, value = 0.0;
  for (int power = 5; power >= 0; power--) value = value * u + c[power] / (power + 1);
  *b = along(c, u);
  return sum + value * u;
}
{% endif %}
{% endfor %}

void bb_start(bb_state *x, double time, double s, double v, bb_beam beam, double phase) {
  x->time = x->begin = time;
  x->beam = beam;
  x->s = x->sensed = x->origin = s;
  x->v = v;
  x->w = 0.0;
  x->phase = phase;
  x->rows = 0;
{% for stage in stages if stage.kind == "play" %}
  x->looked_{{ stage.number }} = 0, x->side_{{ stage.number }} = 0.0, x->stand_{{ stage.number }} = 0.0;
{% endfor %}
{% for stage in stages if stage.kind == "lag" %}
  x->follow_{{ stage.number }} = 0.0;
{% endfor %}
{% for stage in stages if stage.kind == "servo" %}
  x->follow_{{ stage.number }} = x->follow_rate_{{ stage.number }} = 0.0;
{% endfor %}
{% for stage in stages if stage.kind == "hold" %}
  x->past_time_{{ stage.number }}[0] = time, x->past_sum_{{ stage.number }}[0] = 0.0;
{% endfor %}
}

int bb_step(bb_state *x, double time, bb_beam beam) {
  double gap = time - x->time;
  if (!(gap > 0.0)) return 1;
  double wanted = ceil(gap / LONGEST_STEP - 1e-9);
  if (wanted > BB_MAX_STEPS) return 2;
{% for stage in stages if stage.kind == "hold" %}
  if (x->rows >= BB_HISTORY && x->past_time_{{ stage.number }}[(x->rows + 1) % BB_HISTORY] > x->time - {{ stage.names[0] }}) return 3;
{% endfor %}
  int steps = wanted < 1.0 ? 1 : (int)wanted, rows = 2 * steps + 1;
  double h = gap / steps, c[6];
  row_t table[2 * BB_MAX_STEPS + 1];
  /* Between two rows the angle is the quintic through angle, rate and acceleration at both. */
  quintic(x->beam, beam, gap, c);
  table[0].t = x->time, table[0].beam = x->beam;
  for (int i = 1; i < rows - 1; i++) {
    table[i].t = x->time + 0.5 * h * i;
    table[i].beam = along(c, table[i].t - x->time);
  }
  table[rows - 1].t = time, table[rows - 1].beam = beam;
{% for stage in stages %}
{% set n = stage.number %}
{% if stage.kind == "gain" %}
  for (int i = 0; i < rows; i++) { /* beam angle = gain x measured angle */
    table[i].beam.angle *= {{ stage.names[0] }}, table[i].beam.rate *= {{ stage.names[0] }}, table[i].beam.angular *= {{ stage.names[0] }};
  }
{% elif stage.kind == "curve" %}
  for (int i = 0; i < rows; i++) { /* beam angle = a + square a^2 + cube a^3 */
    bb_beam *b = &table[i].beam;
    double a = b->angle, slope = 1.0 + a * (2.0 * {{ stage.names[0] }} + 3.0 * {{ stage.names[1] }} * a);
    double bend = 2.0 * {{ stage.names[0] }} + 6.0 * {{ stage.names[1] }} * a;
    b->angle = a * (1.0 + a * ({{ stage.names[0] }} + a * {{ stage.names[1] }}));
    b->angular = slope * b->angular + bend * b->rate * b->rate;
    b->rate *= slope;
  }
{% elif stage.kind == "play" %}
  { /* play: the beam rests while the linkage crosses the gap, else it follows at half of it */
    const double every = 5e-4, half = 0.5 * {{ stage.names[0] }};
    double piece[6], from = table[0].t;
    quintic(table[0].beam, table[rows - 1].beam, gap, piece);
    if (x->looked_{{ n }} == 0) x->stand_{{ n }} = table[0].beam.angle;
    for (int i = 0; i < rows; i++) {
      while (x->begin + every * (double)x->looked_{{ n }} <= table[i].t) {
        double a = along(piece, x->begin + every * (double)x->looked_{{ n }} - from).angle;
        x->side_{{ n }} = 0.0;
        if (a - x->stand_{{ n }} >= half) x->stand_{{ n }} = a - half, x->side_{{ n }} = 1.0;
        else if (x->stand_{{ n }} - a >= half) x->stand_{{ n }} = a + half, x->side_{{ n }} = -1.0;
        x->looked_{{ n }}++;
      }
      if (x->side_{{ n }} != 0.0) table[i].beam.angle -= x->side_{{ n }} * half;
      else table[i].beam.angle = x->stand_{{ n }}, table[i].beam.rate = 0.0, table[i].beam.angular = 0.0;
    }
  }
{% elif stage.kind == "lag" %}
  if ({{ stage.names[0] }} >= 1e-6) { /* T b' + b = a, solved exactly for a quintic */
    const double T = {{ stage.names[0] }};
    double piece[6], from = table[0].t;
    quintic(table[0].beam, table[rows - 1].beam, gap, piece);
    if (x->rows == 0) { /* settled behind a motion at the first rate: b'' = 0 */
      double second = 2.0 * piece[2] - T * 6.0 * piece[3] + T * T * 24.0 * piece[4] - T * T * T * 120.0 * piece[5];
      x->follow_{{ n }} = settled_{{ n }}(piece, 0.0) - T * T * second;
    }
    double left = x->follow_{{ n }} - settled_{{ n }}(piece, 0.0);
    for (int i = 0; i < rows; i++) {
      double u = table[i].t - from;
      bb_beam a = along(piece, u), *b = &table[i].beam;
      b->angle = settled_{{ n }}(piece, u) + left * exp(-u / T);
      b->rate = (a.angle - b->angle) / T;
      b->angular = (a.rate - b->rate) / T;
    }
    x->follow_{{ n }} = table[rows - 1].beam.angle;
  }
{% elif stage.kind == "servo" %}
  if ({{ stage.names[0] }} >= 1e-5) { /* q b'' + T b' + b = a, q = (T/(2 damping))^2, solved exactly for a quintic */
    const double T = {{ stage.names[0] }}, q = {{ stage.square }};
    double piece[6], from = table[0].t;
    quintic(table[0].beam, table[rows - 1].beam, gap, piece);
    if (x->rows == 0) { /* settled behind a motion at the first rate: b'' = 0 */
      x->follow_{{ n }} = piece[0] - T * piece[1];
      x->follow_rate_{{ n }} = piece[1];
    }
    double left = x->follow_{{ n }} - settled_{{ n }}(piece, 0.0);
    double left_rate = x->follow_rate_{{ n }} - settled_rate_{{ n }}(piece, 0.0);
    for (int i = 0; i < rows; i++) {
      double u = table[i].t - from, y = left, v = left_rate;
      bb_beam a = along(piece, u), *b = &table[i].beam;
      swung_{{ n }}(&y, &v, u);
      b->angle = settled_{{ n }}(piece, u) + y;
      b->rate = settled_rate_{{ n }}(piece, u) + v;
      b->angular = (a.angle - b->angle - T * b->rate) / q;
    }
    x->follow_{{ n }} = table[rows - 1].beam.angle, x->follow_rate_{{ n }} = table[rows - 1].beam.rate;
  }
{% elif stage.kind == "hold" %}
  if ({{ stage.names[0] }} >= 1e-6) { /* mean of the angle over the last interval T */
    const double T = {{ stage.names[0] }};
    double piece[6], from = table[0].t, sum = x->past_sum_{{ n }}[x->rows % BB_HISTORY];
    bb_beam last = table[rows - 1].beam, before, now;
    if (x->rows == 0) x->past_{{ n }}[0] = table[0].beam;
    quintic(table[0].beam, last, gap, piece);
    for (int i = 0; i < rows; i++) {
      double t = table[i].t;
      double late = past_{{ n }}(x, t - T, &before, piece, from, sum), here = past_{{ n }}(x, t, &now, piece, from, sum);
      table[i].beam.angle = (here - late) / T;
      table[i].beam.rate = (now.angle - before.angle) / T;
      table[i].beam.angular = (now.rate - before.rate) / T;
    }
    sum = past_{{ n }}(x, table[rows - 1].t, &now, piece, from, sum);
    x->past_time_{{ n }}[(x->rows + 1) % BB_HISTORY] = time;
    x->past_sum_{{ n }}[(x->rows + 1) % BB_HISTORY] = sum;
    x->past_{{ n }}[(x->rows + 1) % BB_HISTORY] = last;
  }
{% elif stage.kind == "drift" %}
  for (int i = 0; i < rows; i++) { /* the whole rig tilts from the first row on */
    table[i].beam.angle += {{ stage.names[0] }} * (table[i].t - x->begin), table[i].beam.rate += {{ stage.names[0] }};
  }
{% endif %}
{% endfor %}
{% if time_force %}
  for (int i = 0; i < rows; i++) table[i].beam.angle += spline(table[i].t) / GRAVITY; /* a force of time, as a tilt */
{% endif %}
  for (int i = 0; i + 2 < rows; i += 2) {
    /* By Simpson's rule this gives the change of the rate exactly, also where it jumps. */
    double change = (table[i + 2].beam.rate - table[i].beam.rate) / (table[i + 2].t - table[i].t);
    table[i + 1].beam.angular = 0.25 * (6.0 * change - table[i].beam.angular - table[i + 2].beam.angular);
  }
  for (int i = 0; i + 2 < rows; i += 2) advance(x, table + i);
  x->time = time;
  x->beam = beam;
  x->rows++;
  return 0;
}

double bb_recorded(const bb_state *x) {
  double y = x->sensed;
  return SENSOR_GAIN * (y + y * y * (SENSOR_SQUARE + SENSOR_CUBE * y)){{ " + spline(y)" if spline is not none and spline.sensor }};
}

void bb_derive(const double *time, const double *angle, size_t n, double half, bb_beam *out) {
  for (size_t i = 0; i < n; i++) {
    size_t low = i, high = i;
    while (low > 0 && time[i] - time[low - 1] <= half) low--;
    while (high + 1 < n && time[high + 1] - time[i] <= half) high++;
    while (high - low < 6 && (low > 0 || high + 1 < n)) {
      if (low == 0) high++;
      else if (high + 1 == n || time[i] - time[low - 1] < time[high + 1] - time[i]) low--;
      else high++;
    }
    double reach = fmax(fmax(time[i] - time[low], time[high] - time[i]), 1e-9), A[4][5] = {{ '{{' }}0.0}};
    for (size_t j = low; j <= high; j++) {
      double u = (time[j] - time[i]) / reach, power[4] = {1.0, u, u * u, u * u * u};
      for (int a = 0; a < 4; a++) {
        for (int b = 0; b < 4; b++) A[a][b] += power[a] * power[b];
        A[a][4] += power[a] * angle[j];
      }
    }
    int order = high - low < 3 ? (int)(high - low) + 1 : 4; /* a record of fewer rows than a cubic has numbers */
    double x[4] = {0.0, 0.0, 0.0, 0.0};
    for (int a = 0; a < order; a++) { /* Gaussian elimination of a positive definite matrix */
      for (int b = a + 1; b < order; b++) {
        double factor = A[b][a] / A[a][a];
        for (int k = a; k < 5; k++) A[b][k] -= factor * A[a][k];
      }
    }
    for (int a = order - 1; a >= 0; a--) {
      x[a] = A[a][4];
      for (int b = a + 1; b < order; b++) x[a] -= A[a][b] * x[b];
      x[a] /= A[a][a];
    }
    out[i].angle = x[0], out[i].rate = x[1] / reach, out[i].angular = 2.0 * x[2] / (reach * reach);
  }
}

double bb_at(const double *time, const double *y, size_t n, double asked) {
  if (n < 2 || asked <= time[0]) return y[0];
  if (asked >= time[n - 1]) return y[n - 1];
  size_t at = 0, end = n - 1;
  while (end - at > 1) { /* bisection */
    size_t middle = at + (end - at) / 2;
    if (time[middle] <= asked) at = middle;
    else end = middle;
  }
  double h = time[at + 1] - time[at], u = (asked - time[at]) / h, rise = y[at + 1] - y[at], d = rise / h;
  double wide = at > 0 ? time[at] - time[at - 1] : h, far = at + 2 < n ? time[at + 2] - time[at + 1] : h;
  double before = at > 0 ? (y[at] - y[at - 1]) / wide : d, after = at + 2 < n ? (y[at + 2] - y[at + 1]) / far : d;
  double m0 = (before * h + d * wide) / (h + wide) * h, m1 = (d * far + after * h) / (h + far) * h;
  return y[at] + u * (m0 + u * (3.0 * rise - 2.0 * m0 - m1 + u * (m0 + m1 - 2.0 * rise)));
}
