/* The classical Runge-Kutta method for the ball on the beam, as a programmer of C would write it for this model.
 *
 * The same steps, stamps, tables and results as analytic/lean.py. Compiled by benchmarks/performance/in_c.py with
 * gcc -O3 -march=native.
 */
#include <math.h>

/* Of a model: k g, centrifugal, eccentric term, alpha_0; of a dry friction, as deceleration per N/m: along + and -;
 * g, and h + r. */
struct model { double gravity, centrifugal, eccentric, level, plus, minus, weight, height; };

/* sin(alpha + alpha_0) at all rows of a table of alpha, alpha', alpha'', shape (rows, 3). */
void tilts(long rows, const double *table, double level, double *out)
{
  for (long i = 0; i < rows; i++) out[i] = sin(table[3 * i] + level);
}

/* s and s' at every stamp, shape (stamps, 2), the first of which is given. */
void smooth(long stamps, const double *steps, const long *marks, const double *table, const double *tilted,
            const struct model *m, double *out)
{
  double s = out[0], v = out[1];
  for (long stamp = 1; stamp < stamps; stamp++) {
    for (long j = marks[stamp - 1]; j < marks[stamp]; j++) {
      const double h = steps[j], *begin = table + 6 * j, *middle = begin + 3, *end = begin + 6;
      const double *tilt = tilted + 2 * j;
      double k1 = m->gravity * tilt[0] + m->centrifugal * s * begin[1] * begin[1] - m->eccentric * begin[2];
      double v2 = v + 0.5 * h * k1;
      double k2 = m->gravity * tilt[1] + m->centrifugal * (s + 0.5 * h * v) * middle[1] * middle[1]
                  - m->eccentric * middle[2];
      double v3 = v + 0.5 * h * k2;
      double k3 = m->gravity * tilt[1] + m->centrifugal * (s + 0.5 * h * v2) * middle[1] * middle[1]
                  - m->eccentric * middle[2];
      double v4 = v + h * k3;
      double k4 = m->gravity * tilt[2] + m->centrifugal * (s + h * v3) * end[1] * end[1] - m->eccentric * end[2];
      s += h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0;
      v += h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
    }
    out[2 * stamp] = s;
    out[2 * stamp + 1] = v;
  }
}

static double held(const struct model *m, double towards, double s, double v, double cosine, const double *beam)
{
  double pressed = m->weight * cosine - 2.0 * v * beam[1] - s * beam[2] - m->height * beam[1] * beam[1];
  return (towards > 0.0 ? m->plus : m->minus) * (pressed > 0.0 ? pressed : 0.0);
}

/* The same with a friction against rolling that may bring the ball to rest and hold it. */
void dry(long stamps, const double *steps, const long *marks, const double *table, const double *tilted,
         const struct model *m, double *out)
{
  double s = out[0], v = out[1];
  for (long stamp = 1; stamp < stamps; stamp++) {
    for (long j = marks[stamp - 1]; j < marks[stamp]; j++) {
      const double h = steps[j], *begin = table + 6 * j, *middle = begin + 3, *end = begin + 6;
      const double *tilt = tilted + 2 * j;
      double k1 = m->gravity * tilt[0] + m->centrifugal * s * begin[1] * begin[1] - m->eccentric * begin[2];
      double v2 = v + 0.5 * h * k1;
      double k2 = m->gravity * tilt[1] + m->centrifugal * (s + 0.5 * h * v) * middle[1] * middle[1]
                  - m->eccentric * middle[2];
      double v3 = v + 0.5 * h * k2;
      double k3 = m->gravity * tilt[1] + m->centrifugal * (s + 0.5 * h * v2) * middle[1] * middle[1]
                  - m->eccentric * middle[2];
      double v4 = v + h * k3;
      double k4 = m->gravity * tilt[2] + m->centrifugal * (s + h * v3) * end[1] * end[1] - m->eccentric * end[2];
      double s_end = s + h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0;
      double v_end = v + h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
      double drive = (v_end - v) / h, rest = h, cosine = cos(middle[0]);
      if (v != 0.0) {
        double sign = v > 0.0 ? 1.0 : -1.0, limit = held(m, sign, s, v, cosine, middle);
        v_end -= sign * limit * h;
        if (sign * v_end >= 0.0) {
          s = s_end - 0.5 * sign * limit * h * h;
          v = v_end;
          continue;
        }
        double stop = v / (sign * limit - drive);
        s += 0.5 * v * stop;
        rest = h - stop;
      }
      double sign = drive > 0.0 ? 1.0 : -1.0, limit = held(m, sign, s, 0.0, cosine, middle);
      if (fabs(drive) <= limit) {
        v = 0.0;
      } else if (v == 0.0) {
        s = s_end - 0.5 * sign * limit * h * h;
        v = (drive - sign * limit) * h;
      } else {
        v = (drive - sign * limit) * rest;
        s += 0.5 * v * rest;
      }
    }
    out[2 * stamp] = s;
    out[2 * stamp + 1] = v;
  }
}
