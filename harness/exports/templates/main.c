/* Reads rows `time_s,angle_rad[,rate_rad_s,acceleration_rad_s2]` (a header line is skipped) from standard input and prints
 * `time_s,ball_position_m`: what the sensor records. Usage: ball_beam POSITION_M [VELOCITY_M_S [PHASE_RAD]] < rows.csv
 * The ball starts at POSITION_M at the time of the first row. Without rate and acceleration they are derived from the
 * angle by bb_derive over +-0.1 s. */
#include "ball_beam.h"

#include <stdio.h>
#include <stdlib.h>

#define FILTER_HALF_WIDTH 0.1 /* of the local cubic [s] */



int main(int argc, char **argv) {
  static bb_state x; /* may be large */
  char line[512];
  size_t n = 0, room = 0, number = 0;
  int columns = 0;
  double *time = NULL, *angle = NULL, *y = NULL;
  bb_beam *beam = NULL;
  if (argc < 2 || argc > 4) {
    fprintf(stderr, "usage: %s POSITION_M [VELOCITY_M_S [PHASE_RAD]] < rows.csv\n", argv[0]);
    return 2;
  }
  while (fgets(line, sizeof line, stdin)) {
    double t, a, r = 0.0, b = 0.0;
    int read = sscanf(line, "%lf ,%lf ,%lf ,%lf", &t, &a, &r, &b);
    number++;
    if (read <= 0 && number == 1) continue; /* a header */
    if ((read != 2 && read != 4) || (columns && read != columns)) {
      fprintf(stderr, "line %lu: give time_s,angle_rad or time_s,angle_rad,rate_rad_s,acceleration_rad_s2\n",
              (unsigned long)number);
      return 2;
    }
    columns = read;
    if (n == room) {
      room = room ? 2 * room : 1024;
      time = realloc(time, room * sizeof *time), angle = realloc(angle, room * sizeof *angle);
      beam = realloc(beam, room * sizeof *beam);
      if (!time || !angle || !beam) return fprintf(stderr, "no memory\n"), 2;
    }
    time[n] = t, angle[n] = a, beam[n].angle = a, beam[n].rate = r, beam[n].angular = b;
    n++;
  }
  if (n < 2) return fprintf(stderr, "fewer than two rows\n"), 2;
  for (size_t i = 1; i < n; i++) {
    if (!(time[i] > time[i - 1])) {
      return fprintf(stderr, "row %lu at %g s: the time does not increase\n", (unsigned long)i + 1, time[i]), 2;
    }
  }
  if (columns == 2) bb_derive(time, angle, n, FILTER_HALF_WIDTH, beam);
  y = malloc(n * sizeof *y);
  if (!y) return fprintf(stderr, "no memory\n"), 2;
  bb_start(&x, time[0], atof(argv[1]), argc > 2 ? atof(argv[2]) : 0.0, beam[0], argc > 3 ? atof(argv[3]) : 0.0);
  y[0] = bb_recorded(&x);
  for (size_t i = 1; i < n; i++) {
    int fault = bb_step(&x, time[i], beam[i]);
    if (fault) {
      fprintf(stderr, "row %lu at %g s: %s\n", (unsigned long)i + 1, time[i],
              fault == 1 ? "the time does not increase" : "the rows lie too far apart, or too many in an interval");
      return 2;
    }
    y[i] = bb_recorded(&x);
  }
  printf("time_s,ball_position_m\n");
  for (size_t i = 0; i < n; i++) { /* recorded at t is the position at t - delay */
    printf("%.9f,%.9f\n", time[i], bb_delay() == 0.0 ? y[i] : bb_at(time, y, n, time[i] - bb_delay()));
  }
  free(time), free(angle), free(beam), free(y);
  return 0;
}
