// What charts and replays share: per clock the span of time shown and the instant, and on the page the sources switched off.
(() => {
  const clocks = new Map();
  const off = new Set();
  const watchers = [];

  class Clock {
    constructor() {
      this.full = [Infinity, -Infinity];
      this.span = null; // shown; null for all
      this.now = null; // null before anything was chosen
      this.log = false; // whether equal ratios have equal lengths: of an abscissa that is no time
      this.followers = [];
    }

    follow(follower) {
      this.followers.push(follower);
    }

    cover(begin, end) {
      this.full = [Math.min(this.full[0], begin), Math.max(this.full[1], end)];
    }

    get shown() {
      return this.span ?? this.full;
    }

    // Where it is along the axis, and back.
    place(value) {
      return this.log ? Math.log10(value) : value;
    }

    at(place) {
      return this.log ? 10 ** place : place;
    }

    show(begin, end) {
      const [first, last] = this.full.map((one) => this.place(one));
      const wanted = this.place(Math.max(begin, this.log ? this.full[0] * 1e-9 : -Infinity));
      const width = Math.min(this.place(end) - wanted, last - first);
      const from = Math.max(first, Math.min(wanted, last - width));
      this.span = width >= (last - first) * (1 - 1e-9) ? null : [this.at(from), this.at(from + width)];
      for (const each of this.followers) each.span?.(this.shown);
    }

    zoom(factor, at = null) {
      const [begin, end] = this.shown.map((one) => this.place(one));
      const [first, last] = this.full.map((one) => this.place(one));
      const chosen = at ?? (this.now !== null && this.now >= this.shown[0] && this.now <= this.shown[1] ? this.now : null);
      const centre = chosen === null ? (begin + end) / 2 : this.place(chosen);
      if ((end - begin) * factor < (last - first) * 1e-4) return;
      this.show(this.at(centre - (centre - begin) * factor), this.at(centre + (end - centre) * factor));
    }

    // By a share of what is shown, from there or from a span given.
    pan(share, span = this.shown) {
      const [begin, end] = span.map((one) => this.place(one));
      const by = share * (end - begin);
      this.show(this.at(begin + by), this.at(end + by));
    }

    all() {
      this.show(...this.full);
    }

    set(time) {
      this.now = Math.max(this.full[0], Math.min(this.full[1], time));
      for (const each of this.followers) each.now?.(this.now);
    }
  }

  report.clock = (name) => {
    if (!clocks.has(name)) clocks.set(name, new Clock());
    return clocks.get(name);
  };

  report.sources = {
    off,
    watch: (watcher) => watchers.push(watcher),
    turn: (key, on) => {
      if (on) off.delete(key);
      else off.add(key);
      for (const watcher of watchers) watcher(key, on);
    },
  };
})();
