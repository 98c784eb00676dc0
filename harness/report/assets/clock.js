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

    show(begin, end) {
      const [first, last] = this.full;
      const width = Math.min(end - begin, last - first);
      const from = Math.max(first, Math.min(begin, last - width));
      this.span = width >= (last - first) * (1 - 1e-9) ? null : [from, from + width];
      for (const each of this.followers) each.span?.(this.shown);
    }

    zoom(factor, at = null) {
      const [begin, end] = this.shown;
      const centre = at ?? (this.now !== null && this.now >= begin && this.now <= end ? this.now : (begin + end) / 2);
      if ((end - begin) * factor < (this.full[1] - this.full[0]) * 1e-4) return;
      this.show(centre - (centre - begin) * factor, centre + (end - centre) * factor);
    }

    pan(share) {
      const [begin, end] = this.shown;
      const by = share * (end - begin);
      this.show(begin + by, end + by);
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
