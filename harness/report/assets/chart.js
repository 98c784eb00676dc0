// Draws the charts of the page with uPlot in place of their still pictures: zoom, pan, values, switches, linked time.
(() => {
  const { make } = report;
  const charts = new Map();
  report.charts = charts;
  const HEIGHT = 230; // of a panel alone [px]
  const STACKED = 185; // of one of several panels [px]
  const AXIS = 72; // width of the ordinate's labels, equal in all panels [px]
  const CLICK = 4; // a shorter drag is a click [px]
  let drag = null; // the last one: its plot, where it began, the span shown then, whether it moves that span

  function read(data) {
    const x = report.doubles(data.x);
    for (const panel of data.panels)
      for (const one of panel.series) {
        one.y = report.column(one.values);
        one.lower = one.low === null ? null : report.column(one.low);
        if (panel.log) one.y = one.y.map((value) => (value <= 0 && value !== null ? null : value)); // undefined stays so
        if (one.spread !== null) one.spread = report.column(one.spread);
        if (one.notes.length > 0) report.points.prepare(one, data.notes);
        delete one.values;
        delete one.low;
      }
    return x;
  }

  const dashed = (one) => (one.dash === null ? undefined : one.dash.map((part) => part * 1.4));

  // A line through all samples. That of uPlot joins what falls on one pixel, and with it the ends of adjoining runs.
  function lines(plot, at) {
    const path = new Path2D();
    const [x, y] = [plot.data[0], plot.data[at]];
    let drawing = false;
    for (let row = 0; row < x.length; row += 1) {
      if (y[row] === undefined) continue;
      if (y[row] !== null) {
        const across = Math.max(-1e5, Math.min(1e5, plot.valToPos(y[row], "y", true)));
        path[drawing ? "lineTo" : "moveTo"](plot.valToPos(x[row], "x", true), across);
      }
      drawing = y[row] !== null;
    }
    return { stroke: path, fill: null, clip: null, band: null, gaps: null, flags: 0 };
  }

  // Columns and series of a panel as uPlot has them; a band is a pair of invisible lines with the area between.
  function plotted(x, panel) {
    const columns = [x];
    const series = [{}];
    const bands = [];
    const shown = () => true;
    for (const one of panel.series) {
      const base = { show: !report.sources.off.has(one.key), key: one.key, label: one.label, value: shown };
      one.at = [];
      const add = (column, more) => {
        one.at.push(columns.length);
        columns.push(column);
        series.push({ ...base, ...more });
      };
      if (one.lower !== null) {
        const none = { stroke: "transparent", width: 0, points: { show: false } };
        add(one.y, none);
        add(one.lower, none);
        bands.push({ series: [one.at[0], one.at[1]], fill: () => report.theme.variable("--band") });
      } else if (one.dots || one.rows !== undefined) {
        // Of many points, those behind shine through.
        const faded = (colour) => (one.dots && one.rows?.length > 20 ? `color-mix(in srgb, ${colour} 55%, transparent)` : colour);
        const colour = () => faded(report.theme.colour(one.colour));
        add(one.y, {
          paths: one.dots ? () => null : (plot) => report.points.joined(plot, x, one), stroke: colour, width: one.width,
          dash: dashed(one), points: { show: true, size: one.width + (one.dots ? 2.5 : 5), fill: colour, width: 0 },
        });
      } else {
        add(one.y, {
          paths: lines, stroke: () => report.theme.colour(one.colour), width: one.width, dash: dashed(one),
          points: { show: false },
        });
      }
    }
    return { columns, series, bands };
  }

  function axis(label, more = {}) {
    const soft = () => report.theme.variable("--soft");
    const line = { stroke: () => report.theme.variable("--line"), width: 1 };
    return { label, stroke: soft, grid: line, ticks: line, font: "12px system-ui", labelFont: "12px system-ui", ...more };
  }

  const named = (label, unit) => (unit === "" ? label : `${label} [${unit}]`);
  function zeroLine(plot) {
    const y = Math.round(plot.valToPos(0, "y", true));
    const { left, top, width, height } = plot.bbox;
    if (y < top || y > top + height) return;
    plot.ctx.save();
    plot.ctx.strokeStyle = report.theme.variable("--ink");
    plot.ctx.lineWidth = devicePixelRatio * 0.8;
    plot.ctx.setLineDash([]); // that of the last series stays set
    plot.ctx.beginPath();
    plot.ctx.moveTo(left, y);
    plot.ctx.lineTo(left + width, y);
    plot.ctx.stroke();
    plot.ctx.restore();
  }

  const COLOURS = { failure: "--bad", heldout: "--heldout", identify: "--identify", window: "--line", left_out: "--bad" };
  function drawMarks(plot, marks) {
    const { left, top, width, height } = plot.bbox;
    for (const mark of marks) {
      const [from, to] = [mark.begin, mark.end].map((time) => plot.valToPos(time, "x", true));
      if (to < left || from > left + width) continue;
      const begin = Math.max(from, left);
      plot.ctx.save();
      plot.ctx.fillStyle = report.theme.variable(COLOURS[mark.kind]);
      plot.ctx.globalAlpha = mark.kind === "window" ? 1 : mark.end > mark.begin ? 0.13 : 0.7;
      const wide = mark.kind === "window" ? devicePixelRatio : Math.max(Math.min(to, left + width) - begin, 1.5);
      plot.ctx.fillRect(begin, top, wide, height);
      plot.ctx.restore();
    }
  }

  class Chart {
    constructor(figure, data) {
      this.figure = figure;
      this.data = data;
      this.x = read(data);
      this.clock = report.clock(data.clock === "" ? `of ${data.id}` : data.clock);
      this.clock.log = data.log;
      this.clock.cover(...this.covered());
      this.points = report.points.all(data.panels).length > 0;
      this.picked = null;
      this.plots = [];
      this.heads = [];
      this.rings = [];
      this.hovered = null;
      const image = figure.querySelector("img");
      const name = data.clock === "" ? `${image.alt} Against ${data.label}.` : image.alt;
      this.place = make("div", {
        class: data.clock === "" ? "live" : "live over-time", role: "group", "aria-label": name, "data-chart": data.id,
      });
      image.before(this.place);
      this.place.append(this.controls(), this.switches());
      this.place.addEventListener("keydown", (event) => this.key(event));
    }

    // With room beside the first and the last point, which would be cut by the frame.
    covered() {
      const rows = this.data.panels.filter((panel) => panel.names.length > 0);
      const far = [this.x[0], this.x[this.x.length - 1], ...rows.flatMap((panel) => report.rows.covered(this.x, panel, this.data.log))];
      const ends = [Math.min(...far), Math.max(...far)];
      if (this.data.panels.every((panel) => panel.series.every((one) => one.rows === undefined))) return ends;
      const [begin, end] = ends.map((one) => this.clock.place(one));
      const room = 0.05 * (end - begin) || (this.clock.log ? 0.2 : Math.abs(begin) * 0.1 || 1);
      return [this.clock.at(begin - room), this.clock.at(end + room)];
    }

    controls() {
      const button = (text, label, act) =>
        make("button", { type: "button", "aria-label": label, title: label, click: act }, text);
      const { clock } = this;
      this.readout = make("span", { class: "at" });
      this.said = make("p", { class: "picked", role: "status" });
      const points = this.points
        ? [button("‹", "Previous point", () => this.step(-1)), button("›", "Next point", () => this.step(1))] : [];
      return make(
        "div", { class: "controls" },
        button("+", "Zoom in", () => clock.zoom(0.5)),
        button("−", "Zoom out", () => clock.zoom(2)),
        button("◀", "Move left", () => clock.pan(-0.25)),
        button("▶", "Move right", () => clock.pan(0.25)),
        button("All", "Show all", () => clock.all()),
        ...points, this.readout,
      );
    }

    // One switch a source, with its value where the cursor is, in every panel that has it.
    switches() {
      const list = make("ul", { class: "switches", "aria-label": "Shown in this plot" });
      const entries = new Map();
      this.data.panels.forEach((panel, number) => {
        for (const one of panel.series) {
          if (!entries.has(one.key)) entries.set(one.key, { one, each: [] });
          entries.get(one.key).each.push({ one, panel, number });
        }
      });
      this.entries = [...entries.values()].map(({ one, each }) => {
        const box = make("input", {
          type: "checkbox", checked: !report.sources.off.has(one.key), "data-key": one.key,
          change: () => report.sources.turn(one.key, box.checked),
        });
        const value = make("span", { class: "value" });
        const style = one.lower !== null ? "band" : one.dots ? "dots" : one.dash ? "dashed" : "line";
        const swatch = make("span", { class: `key ${style}`, style: `--colour:${report.theme.ink(one.colour)}` });
        list.append(make("li", {}, make("label", {}, box, swatch, ...report.symbols(one.label)), value));
        return { key: one.key, box, value, each };
      });
      return list;
    }

    key(event) {
      if (event.altKey || event.ctrlKey || event.metaKey) return;
      const acts = {
        "+": () => this.clock.zoom(0.5), "=": () => this.clock.zoom(0.5), "-": () => this.clock.zoom(2),
        ArrowLeft: () => this.clock.pan(-0.1), ArrowRight: () => this.clock.pan(0.1), 0: () => this.clock.all(),
      };
      if (!(event.key in acts)) return;
      event.preventDefault();
      acts[event.key]();
    }

    draw() {
      const { data } = this;
      const wide = this.place.clientWidth;
      const height = data.panels.length > 1 ? STACKED : HEIGHT;
      data.panels.forEach((panel, number) => {
        const last = number === data.panels.length - 1;
        const rows = panel.names.length > 0;
        const { columns, series, bands } = plotted(this.x, panel);
        const holder = make("div", { class: "panel" });
        if (panel.title !== "") holder.append(make("p", { class: "panel-title" }, panel.title));
        this.place.append(holder);
        const options = {
          width: wide, height: (rows ? report.rows.height(panel) : height) + (last ? 30 : 0), series, bands, legend: { show: false },
          scales: {
            x: { time: false, range: (_, low, high) => [low, high], ...(data.log ? { distr: 3 } : {}) },
            y: { range: (plot, low, high) => this.limits(panel, low, high), ...(panel.log ? { distr: 3 } : {}) },
          },
          axes: [
            axis(last ? named(data.label, data.unit) : null, {
              size: last ? 36 : 22, labelSize: last ? 20 : 0, values: last ? report.axes.texts : () => [],
              ...(data.log ? report.axes.log : {}),
            }),
            rows ? axis(null, { size: 12, values: () => [], splits: () => panel.names.map((_, row) => 0.62 - row) })
              : axis(named(panel.label, panel.unit), {
                size: AXIS, labelSize: 18, values: report.axes.texts, ...(panel.log ? report.axes.log : {}),
              }),
          ],
          cursor: {
            sync: { key: this.data.clock === "" ? this.data.id : this.data.clock, setSeries: false },
            drag: { x: true, y: false, setScale: false, dist: CLICK },
            points: { show: (plot, at) => plot.series[at].width > 0 && plot.series[at].points.show !== true },
            y: false,
          },
          hooks: {
            setCursor: [(plot) => this.hover(plot)],
            setSelect: [(plot) => this.selected(plot)],
            drawClear: [(plot) => drawMarks(plot, data.marks)],
            draw: [
              ...(rows ? [(drawn) => report.rows.draw(drawn, panel, data.log)] : panel.zero ? [zeroLine] : []),
              (drawn) => this.bars(drawn, panel),
              () => this.ring(),
              () => this.instant(),
            ],
          },
        };
        const plot = new uPlot(options, columns, holder);
        const head = make("div", { class: "playhead", hidden: true });
        const ring = make("div", { class: "ring", hidden: true });
        plot.over.append(head, ring);
        this.pointer(plot);
        this.plots.push(plot);
        this.heads.push(head);
        this.rings.push(ring);
      });
      if (this.points) this.place.append(this.said);
      this.pick(null);
      this.clock.follow({ span: () => this.rescale(), now: (time) => this.moved(time) });
      new ResizeObserver(() => this.resize()).observe(this.place);
      this.values(this.clock.now ?? this.clock.full[0]);
      if (this.clock.now !== null) this.moved(this.clock.now);
    }

    // Of the data in sight, but never beyond the frame: a source that runs away does not flatten the others.
    limits(panel, low, high) {
      if (panel.names.length > 0) return report.rows.ends(panel);
      if (low === null || high === null) [low, high] = panel.frame ?? [panel.log ? 0.1 : 0, 1];
      if (panel.frame !== null) {
        const [least, most] = panel.frame;
        [low, high] = low > most || high < least ? [least, most] : [Math.max(low, least), Math.min(high, most)];
      }
      if (panel.log) return low > 0 ? [low / 1.3, high * 1.3] : [high * 1e-6, high];
      const room = 0.06 * (high - low) || Math.abs(high) * 0.1 || 1;
      return [low - room, high + room];
    }

    pointer(plot) {
      const over = plot.over;
      over.addEventListener("mousedown", (event) => {
        drag = { plot, x: event.clientX, span: this.clock.shown, moves: event.shiftKey };
      });
      over.addEventListener("mousemove", (event) => {
        if (drag?.plot === plot && drag.moves && event.buttons !== 0)
          this.clock.pan((drag.x - event.clientX) / over.clientWidth, drag.span);
      });
      over.addEventListener("click", (event) => {
        const still = drag === null || Math.abs(event.clientX - drag.x) < CLICK;
        const at = plot.posToVal(event.clientX - over.getBoundingClientRect().left, "x");
        if (still) this.clock.set(at);
      });
      over.addEventListener("dblclick", () => this.clock.all());
      // With Ctrl as in maps on a page: the wheel alone scrolls the page.
      over.addEventListener("wheel", (event) => {
        if (!event.ctrlKey) return;
        event.preventDefault();
        const at = plot.posToVal(event.clientX - over.getBoundingClientRect().left, "x");
        this.clock.zoom(event.deltaY > 0 ? 1.25 : 0.8, at);
      }, { passive: false });
    }

    selected(plot) {
      const { left, width } = plot.select;
      if (width < CLICK) return;
      const span = [plot.posToVal(left, "x"), plot.posToVal(left + width, "x")];
      plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
      if (drag?.plot === plot && !drag.moves) this.clock.show(...span); // linked plots are told of the drag, too
    }

    rescale() {
      const [min, max] = this.clock.shown;
      for (const plot of this.plots) plot.setScale("x", { min, max }); // applied when it is drawn
    }

    hover(plot) {
      const left = plot.cursor.left;
      this.hovered = left === undefined || left < 0 ? null : plot.posToVal(left, "x");
      this.values(this.hovered ?? this.clock.now ?? this.clock.full[0]);
      if (!this.points || this.hovered === null) return;
      const number = this.plots.indexOf(plot);
      const found = report.points.nearest(plot, this.x, this.data.panels[number], left, plot.cursor.top);
      this.pick(found === null ? null : { ...found, panel: number });
    }

    // What the chosen point is, in words and by a ring.
    pick(point) {
      this.picked = point;
      this.said.textContent = point === null
        ? "No point is chosen." : report.points.text(this.data, this.x, this.data.panels[point.panel], point);
      this.ring();
    }

    ring() {
      this.rings.forEach((ring, number) => {
        const plot = this.plots[number];
        const here = this.picked !== null && this.picked.panel === number && !report.sources.off.has(this.picked.one.key);
        ring.hidden = !here;
        if (!here) return;
        const { one, row } = this.picked;
        const [left, top] = [plot.valToPos(this.x[row], "x"), plot.valToPos(one.y[row], "y")];
        ring.hidden = !report.points.inside(plot, left, top);
        ring.style.transform = `translate(${left}px, ${top}px)`;
      });
    }

    step(by) {
      const every = report.points.all(this.data.panels);
      if (every.length === 0) return;
      const { one, row, panel } = this.picked ?? {};
      const at = every.findIndex((each) => each.one === one && each.row === row && each.panel === panel);
      this.pick(every[at < 0 ? (by > 0 ? 0 : every.length - 1) : (at + by + every.length) % every.length]);
    }

    bars(plot, panel) {
      for (const one of panel.series)
        if (one.rows !== undefined && one.spread !== null && !report.sources.off.has(one.key))
          report.points.bars(plot, this.x, one, panel);
    }

    // The line at the chosen instant, by the scale as it is drawn.
    instant() {
      const time = this.clock.now;
      if (time === null) return;
      const timed = this.data.clock !== "";
      this.heads.forEach((head, number) => {
        const plot = this.plots[number];
        const at = plot.valToPos(time, "x");
        head.hidden = !timed || at < 0 || at > plot.over.clientWidth;
        head.style.transform = `translateX(${at}px)`;
      });
    }

    moved(time) {
      this.instant();
      if (this.hovered === null) this.values(time);
    }

    values(at) {
      const idle = this.points && this.hovered === null; // points have no instant
      this.readout.textContent = idle ? "" : `${this.data.label} ${report.text(at, this.data.unit)}`;
      for (const entry of this.entries)
        entry.value.textContent = idle ? "" : entry.each
          .filter(({ one }) => !one.dots && one.rows === undefined)
          .map(({ one, panel }) => {
            const value = report.valueAt(this.x, one.y, at);
            if (one.lower === null) return report.text(value, panel.unit);
            const lower = report.valueAt(this.x, one.lower, at);
            return `${report.text(lower, "")}\u00a0…\u00a0${report.text(value, panel.unit)}`; // breaks between panels alone
          })
          .join(", ");
    }

    turn(key, on) {
      this.data.panels.forEach((panel, number) => {
        for (const one of panel.series)
          if (one.key === key) for (const at of one.at) this.plots[number].setSeries(at, { show: on });
      });
      for (const entry of this.entries) if (entry.key === key) entry.box.checked = on;
      if (!on && this.picked !== null && this.picked.one.key === key) this.pick(null);
    }

    resize() {
      const width = this.place.clientWidth;
      if (width === 0) return; // on paper
      for (const plot of this.plots) if (plot.width !== width) plot.setSize({ width, height: plot.height });
    }
  }

  for (const script of document.querySelectorAll("script.chart-data")) {
    const figure = script.closest("figure");
    const chart = new Chart(figure, JSON.parse(script.textContent));
    charts.set(chart.data.id, chart);
  }
  // After all have told their clock what they cover: linked charts show the same span.
  for (const chart of charts.values()) {
    chart.figure.classList.add("is-live");
    chart.draw();
    chart.rescale();
  }
  report.sources.watch((key, on) => charts.forEach((chart) => chart.turn(key, on)));
  report.theme.watch(() => charts.forEach((chart) => chart.plots.forEach((plot) => plot.redraw(false, true))));
})();
