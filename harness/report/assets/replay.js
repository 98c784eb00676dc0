// The replay: the beam from the side and the balls of all sources, at the instant that its clock and the plots share.
(() => {
  const { make } = report;
  make.svg.add("text");
  const TALLEST = 300; // of the drawing [px]
  const EDGE = 34; // free beside the beam [px]
  const SMALLEST = 5; // radius of a drawn ball [px]
  const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5];
  const STEP = 0.02; // of an arrow key [s]
  const CALM = 500; // between steps where the system asks for less motion [ms]
  const calm = matchMedia("(prefers-reduced-motion: reduce)");

  class Replay {
    constructor(place, data) {
      Object.assign(this, { place, data, speed: 1, gain: 1, playing: null });
      this.runs = data.runs.map((run) => ({
        ...run, t: report.doubles(run.time), alpha: report.column(run.angle), shown: report.charts.get(run.chart),
      }));
      this.build();
      this.choose(0);
      for (const name of new Set(this.runs.map((run) => run.clock)))
        report.clock(name).follow({ now: (time) => name === this.run.clock && this.show(time) });
      report.sources.watch(() => this.show(this.clock.now));
      report.theme.watch(() => this.balls.forEach((ball) => this.paint(ball)));
      new ResizeObserver(() => this.layout()).observe(this.stage);
    }

    build() {
      const select = (label, options, act) => {
        const list = make("select", { change: () => act(Number(list.value)) });
        for (const [value, text, chosen] of options) list.append(make("option", { value, selected: chosen }, text));
        return make("label", {}, `${label} `, list);
      };
      this.play = make("button", { type: "button", class: "play", click: () => this.toggle() }, "▶ Play");
      this.slider = make("input", {
        type: "range", "aria-label": "Time of the replay", step: "any", class: "time",
        input: () => this.clock.set(Number(this.slider.value)),
      });
      this.strip = make("div", { class: "strip", "aria-hidden": "true" });
      this.instant = make("output", { class: "at" });
      this.stage = make("div", { class: "stage" });
      this.list = make("ul", { class: "switches", "aria-label": "Shown in the replay" });
      this.jumps = make("details", { class: "jumps" });
      this.said = make("p", { class: "unseen", role: "status" });
      const controls = make(
        "div", { class: "controls" }, this.play,
        make("button", { type: "button", "aria-label": "One step back", click: () => this.step(-STEP) }, "◂"),
        make("button", { type: "button", "aria-label": "One step forward", click: () => this.step(STEP) }, "▸"),
        select("Speed", SPEEDS.map((one) => [one, `${one} ×`, one === 1]), (value) => (this.speed = value)),
        select("Tilt", [[1, "as it is", true], [5, "5 × larger", false]], (value) => {
          this.gain = value;
          this.layout();
        }),
      );
      if (this.runs.length > 1)
        controls.append(select("Runs", this.runs.map((one, at) => [at, one.title, at === 0]), (at) => this.choose(at)));
      controls.append(this.instant);
      const track = make("div", { class: "track" }, this.slider, this.strip);
      this.place.append(controls, this.stage, track, this.jumps, this.list, this.said);
      this.place.addEventListener("keydown", (event) => this.key(event));
      this.place.hidden = false;
    }

    get clock() {
      return report.clock(this.run.clock);
    }

    // Another run on the same beam; the instant stays where both have it.
    choose(at) {
      const now = this.run === undefined ? null : this.clock.now;
      this.run = this.runs[at];
      const { t, shown, marks } = this.run;
      this.begin = Math.max(t[0], shown.x[0]);
      this.end = Math.min(t[t.length - 1], shown.x[shown.x.length - 1]);
      Object.assign(this.slider, { min: this.begin, max: this.end });
      this.series = shown.data.panels[0].series.filter((one) => !one.dots && one.lower === null);
      this.unit = shown.data.panels[0].unit;
      this.list.replaceChildren();
      this.entries = this.series.map((one) => {
        const box = make("input", {
          type: "checkbox", checked: !report.sources.off.has(one.key), "data-key": one.key,
          change: () => report.sources.turn(one.key, box.checked),
        });
        const value = make("span", { class: "value" });
        const filled = one.key === this.data.reference ? " filled" : "";
        const swatch = make("span", { class: `key ball${filled}`, style: `--colour:${report.theme.ink(one.colour)}` });
        this.list.append(make("li", {}, make("label", {}, box, swatch, one.label), value));
        return { one, box, value };
      });
      this.drawMarks(marks);
      this.layout();
      const time = now ?? this.clock.now ?? this.begin;
      this.clock.set(Math.max(this.begin, Math.min(this.end, time)));
    }

    drawMarks(marks) {
      const share = (time) => (100 * (Math.max(this.begin, Math.min(this.end, time)) - this.begin)) / (this.end - this.begin);
      this.strip.replaceChildren(
        ...marks.map((mark) => make("span", {
          class: `mark ${mark.kind}`, title: mark.label,
          style: `left:${share(mark.begin)}%;width:${share(mark.end) - share(mark.begin)}%`,
        })),
      );
      const jump = (mark) => make(
        "li", {},
        make("button", { type: "button", class: `jump ${mark.kind}`, click: () => this.clock.set(mark.begin) },
          report.text(mark.begin, "s"), mark.end > mark.begin ? `–${report.text(mark.end, "s")}` : ""),
        ` ${mark.label}`,
      );
      this.jumps.hidden = marks.length === 0;
      this.jumps.replaceChildren(make("summary", {}, `Marks on the time slider (${marks.length})`),
        make("ul", { tabindex: 0, "aria-label": "Marks" }, ...marks.map(jump)));
    }

    // The drawing at the page's width; lengths along the beam and across it have one scale.
    layout() {
      const width = this.stage.clientWidth;
      if (width === 0 || this.run === undefined) return;
      const { low, high, eccentricity, rolling, radius } = this.data;
      const steepest = this.run.alpha.reduce((most, one) => Math.max(most, Math.abs(one ?? 0)), 0) * this.gain;
      const across = Math.sin(Math.min(steepest, 1.5)) * Math.max(Math.abs(low), Math.abs(high));
      const above = Math.abs(eccentricity) + rolling + radius;
      const wanted = (width - 2 * EDGE) / (high - low);
      const scale = Math.min(wanted, (TALLEST - 40) / (2 * across + above + 0.01));
      this.scale = scale;
      const top = across * scale + above * scale + 16;
      const height = top + across * scale + Math.max(0, radius - rolling) * scale + 28;
      const left = width / 2 - ((low + high) / 2) * scale;
      const y = -eccentricity * scale;
      const beam = make("g", { class: "beam" });
      beam.append(make("line", { class: "rail", x1: low * scale, x2: high * scale, y1: y, y2: y }));
      beam.append(make("line", { class: "post", x1: 0, x2: 0, y1: y, y2: 0 }));
      const under = 18 + Math.max(0, radius - rolling) * scale; // below the ball, which sinks between the edges
      const apart = [0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5].find((one) => one * scale > 52) ?? 10;
      for (let at = Math.ceil(low / apart); at * apart <= high; at += 1) {
        const x = at * apart * scale;
        beam.append(make("line", { class: "tick", x1: x, x2: x, y1: y, y2: y + 6 }));
        const label = make("text", { x, y: y + under, "text-anchor": "middle" }, report.text(at * apart, "", 3));
        if (at !== 0) beam.append(label);
      }
      beam.append(make("text", { x: high * scale + 4, y: y + 4 }, "m"));
      const size = Math.max(radius * scale, SMALLEST);
      const height0 = y - Math.max(rolling * scale, SMALLEST * (rolling / radius));
      this.balls = this.series.map((one) => {
        const ball = make("circle", { r: size, cy: height0, class: one.key === this.data.reference ? "measured" : "model",
          "data-key": one.key });
        const pair = { one, ball };
        this.paint(pair);
        return pair;
      });
      // The measured ball lies below the others, which are outlines.
      const ordered = [...this.balls].sort((a, b) => (b.one.key === this.data.reference) - (a.one.key === this.data.reference));
      beam.append(...ordered.map((pair) => pair.ball));
      this.beam = beam;
      this.pivot = [left, top];
      this.level = make("line", { class: "level", x1: left + low * scale, x2: left + high * scale, y1: top, y2: top });
      const foot = `${left},${top} ${left - 9},${top + 16} ${left + 9},${top + 16}`;
      this.svg = make(
        "svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": "Beam and balls" },
        this.level, make("polygon", { class: "foot", points: foot }), beam,
        make("circle", { class: "axis", cx: left, cy: top, r: 3 }),
      );
      this.stage.replaceChildren(this.svg);
      this.show(this.clock.now ?? this.begin);
    }

    paint({ one, ball }) {
      const colour = report.theme.colour(one.colour);
      if (one.key === this.data.reference) ball.setAttribute("style", `fill:${colour}`);
      else ball.setAttribute("style", `stroke:${colour};stroke-dasharray:${one.dash ? one.dash.join(" ") : "none"}`);
    }

    show(time) {
      if (time === null || this.svg === undefined) return;
      const { shown, t, alpha } = this.run;
      const at = Math.max(this.begin, Math.min(this.end, time));
      const angle = report.valueAt(t, alpha, at) ?? 0;
      const degrees = (angle * 180) / Math.PI;
      this.beam.setAttribute("transform", `translate(${this.pivot[0]} ${this.pivot[1]}) rotate(${degrees * this.gain})`);
      const reference = this.series.find((one) => one.key === this.data.reference);
      const measured = reference === undefined ? null : report.valueAt(shown.x, reference.y, at);
      this.balls.forEach(({ one, ball }) => {
        const position = report.valueAt(shown.x, one.y, at);
        const inside = position !== null && position >= this.data.low && position <= this.data.high;
        ball.toggleAttribute("hidden", !inside || report.sources.off.has(one.key));
        if (inside) ball.setAttribute("cx", position * this.scale);
        if (inside) ball.dataset.position = position;
      });
      for (const { one, box, value } of this.entries) {
        const position = report.valueAt(shown.x, one.y, at);
        box.checked = !report.sources.off.has(one.key);
        const beyond = position !== null && (position < this.data.low || position > this.data.high);
        const away = position === null || measured === null || one === reference ? "" :
          ` (${position >= measured ? "+" : ""}${report.text(Number((1e3 * (position - measured)).toFixed(2)), "mm", 6)})`;
        value.textContent = position === null ? "no value" : report.text(position, this.unit) + away + (beyond ? " ⇥ out of sight" : "");
      }
      const text = `${at.toFixed(2)} s, α = ${degrees.toFixed(2).replace(/^-(?=0\.00$)/, "").replace("-", "−")}°`;
      this.instant.textContent = text;
      this.slider.value = at;
      this.slider.setAttribute("aria-valuetext", `${at.toFixed(2)} seconds`);
      if (this.playing === null) this.describe(text);
    }

    describe(text) {
      const balls = this.entries.filter(({ one }) => !report.sources.off.has(one.key))
        .map(({ one, value }) => `${one.label} ${value.textContent}`);
      this.svg.setAttribute("aria-label", `Beam and balls at ${text}. ${balls.join("; ")}.`);
    }

    step(by) {
      this.pause();
      this.clock.set(Math.max(this.begin, Math.min(this.end, this.clock.now + by)));
    }

    toggle() {
      if (this.playing !== null) this.pause();
      else this.start();
    }

    start() {
      if (this.clock.now >= this.end) this.clock.set(this.begin);
      this.play.textContent = "❚❚ Pause";
      let before = null;
      const next = (now) => {
        before ??= now;
        const passed = now - before;
        if (!calm.matches || passed >= CALM) {
          before = now;
          this.clock.set(Math.min(this.end, this.clock.now + (passed / 1000) * this.speed));
          if (this.clock.now >= this.end) return this.pause();
        }
        this.playing = requestAnimationFrame(next);
        return undefined;
      };
      this.playing = requestAnimationFrame(next);
    }

    pause() {
      if (this.playing !== null) cancelAnimationFrame(this.playing);
      this.playing = null;
      this.play.textContent = "▶ Play";
      this.show(this.clock.now);
      this.said.textContent = `Paused at ${this.instant.textContent}`;
    }

    key(event) {
      if (event.altKey || event.ctrlKey || event.metaKey) return;
      const own = event.target.matches("button, select, summary, input[type=checkbox]");
      const range = event.target === this.slider;
      const by = event.shiftKey ? 1 : STEP;
      const acts = {
        ArrowLeft: () => this.step(-by), ArrowRight: () => this.step(by),
        Home: () => this.step(-Infinity), End: () => this.step(Infinity),
      };
      if (event.key === " " && !own) acts[" "] = () => this.toggle();
      if (!(event.key in acts) || (event.target.matches("select") && !range)) return;
      event.preventDefault();
      acts[event.key]();
    }
  }

  report.replays = [...document.querySelectorAll("script.replay-data")].map(
    (script) => new Replay(script.parentElement.querySelector(".replay"), JSON.parse(script.textContent)),
  );
})();
