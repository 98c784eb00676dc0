/* Reads rows `time_s,angle_rad[,rate_rad_s,acceleration_rad_s2]` (a header line is skipped) from standard input and prints
 * `time_s,ball_position_m`: what the sensor records. Usage: ball_beam POSITION_M [VELOCITY_M_S [PHASE_RAD]] < rows.csv
 * The ball starts at POSITION_M at the time of the first row. Without rate and acceleration they are derived from the
 * angle by bb_derive over +-0.1 s. With a negative delay the last positions need angles after the last row: blank. */
#include "ball_beam.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FILTER_HALF_WIDTH 0.1 /* of the local cubic [s] */
#define BLANKS " \t\r\n\v\f"
#define HEADER (-1) /* a line that does not begin with a number */

/* A finite decimal number, blanks about it, that is all of a text of this length. Returns 0 if it is. */
static int number_in(const char *text, size_t length, double *value) {
  char copy[64], *end;
  while (length && strchr(BLANKS, text[length - 1])) length--;
  while (length && strchr(BLANKS, *text)) text++, length--;
  if (!length || length >= sizeof copy || strspn(text, "+-.0123456789eE") < length) return 1;
  memcpy(copy, text, length), copy[length] = '\0';
  *value = strtod(copy, &end);
  return *end != '\0' || !isfinite(*value);
}

/* Cells of a line, up to four. Returns their number; HEADER or 0 where one is no number, 5 where there are more. */
static int row_in(const char *text, double cell[4]) {
  for (int count = 0;; count++) {
    size_t length = strcspn(text, ",");
    if (count == 4) return 5;
    if (number_in(text, length, &cell[count])) return count ? 0 : HEADER;
    if (text[length] == '\0') return count + 1;
    text += length + 1;
  }
}

int main(int argc, char **argv) {
  static bb_state x; /* may be large */
  char line[512];
  size_t n = 0, room = 0, number = 0, blank = 0;
  int columns = 0;
  double start[3] = {0.0, 0.0, 0.0}, *time = NULL, *angle = NULL, *y = NULL;
  bb_beam *beam = NULL;
  if (argc < 2 || argc > 4) {
    fprintf(stderr, "usage: %s POSITION_M [VELOCITY_M_S [PHASE_RAD]] < rows.csv\n", argv[0]);
    return 2;
  }
  for (int i = 1; i < argc; i++) {
    if (number_in(argv[i], strlen(argv[i]), &start[i - 1])) {
      return fprintf(stderr, "%s is not a finite number\n", argv[i]), 2;
    }
  }
  while (fgets(line, sizeof line, stdin)) {
    double cell[4];
    const char *text = number++ == 0 && strncmp(line, "\xef\xbb\xbf", 3) == 0 ? line + 3 : line; /* a byte order mark */
    int read = row_in(text, cell);
    if (number == 1 && read == HEADER) continue;
    if (line[strspn(line, BLANKS)] == '\0') { /* blank lines may end the file */
      blank = blank ? blank : number;
      continue;
    }
    if (blank || (read != 2 && read != 4) || (columns && read != columns)) {
      fprintf(stderr, "line %lu: give time_s,angle_rad or these and rate_rad_s,acceleration_rad_s2, finite numbers\n",
              (unsigned long)(blank ? blank : number));
      return 2;
    }
    columns = read;
    if (n == room) {
      room = room ? 2 * room : 1024;
      time = realloc(time, room * sizeof *time), angle = realloc(angle, room * sizeof *angle);
      beam = realloc(beam, room * sizeof *beam);
      if (!time || !angle || !beam) return fprintf(stderr, "no memory\n"), 2;
    }
    time[n] = cell[0], angle[n] = beam[n].angle = cell[1];
    beam[n].rate = read == 4 ? cell[2] : 0.0, beam[n].angular = read == 4 ? cell[3] : 0.0;
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
  bb_start(&x, time[0], start[0], start[1], beam[0], start[2]);
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
    double asked = time[i] - bb_delay();
    if (bb_delay() < 0.0 && asked > time[n - 1]) {
      printf("%.9f,\n", time[i]);
      continue;
    }
    printf("%.9f,%.9f\n", time[i], bb_delay() == 0.0 ? y[i] : bb_at(time, y, n, asked));
  }
  free(time), free(angle), free(beam), free(y);
  return 0;
}
