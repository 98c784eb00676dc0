// Points that tell what they are: their error bars, which one is nearest to the mouse, what is said of it.
(() => {
  const REACH = 40; // farther from every point the mouse means none [px]

  // Rows of the samples of one series, in the order in which its line joins them.
  function rowsOf(one) {
    const present = [];
    one.y.forEach((value, row) => value !== undefined && present.push(row));
    return one.order.map((rank) => present[rank]);
  }

  // What was read of a series of points: rows and notes in the order of its line.
  function prepare(one, notes) {
    one.rows = rowsOf(one);
    one.notes = one.order.map((rank) => notes[one.notes[rank]]);
  }

  // A line from point to point; a point without a value breaks it.
  function joined(plot, x, one) {
    const path = new Path2D();
    let drawing = false;
    for (const row of one.rows) {
      const value = one.y[row];
      if (value !== null) path[drawing ? "lineTo" : "moveTo"](plot.valToPos(x[row], "x", true), plot.valToPos(value, "y", true));
      drawing = value !== null;
    }
    return { stroke: path, fill: null, clip: null, band: null, gaps: null, flags: 0 };
  }

  // A bar that goes below what a logarithmic axis can show ends at its foot. In rows bars lie.
  function bars(plot, x, one, panel) {
    const { ctx } = plot;
    const { left, top, width, height } = plot.bbox;
    const foot = plot.scales.y.min;
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    ctx.beginPath();
    for (const row of one.rows) {
      const [value, half] = [one.y[row], one.spread[row]];
      if (value === null || half === null || half === undefined) continue;
      if (panel.names.length > 0) {
        const across = plot.valToPos(value, "y", true);
        ctx.moveTo(plot.valToPos(x[row] - half, "x", true), across);
        ctx.lineTo(plot.valToPos(x[row] + half, "x", true), across);
        continue;
      }
      const low = panel.log ? Math.max(value - half, foot) : value - half;
      const at = plot.valToPos(x[row], "x", true);
      ctx.moveTo(at, plot.valToPos(low, "y", true));
      ctx.lineTo(at, plot.valToPos(value + half, "y", true));
    }
    ctx.strokeStyle = report.theme.colour(one.colour);
    ctx.lineWidth = devicePixelRatio * 1.2;
    ctx.setLineDash([]); // that of the last series stays set
    ctx.stroke();
    ctx.restore();
  }

  const inside = (plot, left, top) =>
    left >= -1 && left <= plot.over.clientWidth + 1 && top >= -1 && top <= plot.over.clientHeight + 1;

  // The point of a panel that is nearest to a place in its plot [px]; null where none is near.
  function nearest(plot, x, panel, left, top) {
    let [best, least] = [null, REACH];
    for (const one of panel.series) {
      if (one.rows === undefined || report.sources.off.has(one.key)) continue;
      one.rows.forEach((row, number) => {
        if (one.y[row] === null) return;
        const [across, down] = [plot.valToPos(x[row], "x"), plot.valToPos(one.y[row], "y")];
        const apart = Math.hypot(across - left, down - top);
        if (apart < least && inside(plot, across, down)) [best, least] = [{ one, row, number }, apart];
      });
    }
    return best;
  }

  // All points of a chart that are switched on, panel by panel.
  function all(panels) {
    const found = [];
    panels.forEach((panel, at) => {
      for (const one of panel.series)
        if (one.rows !== undefined && !report.sources.off.has(one.key))
          one.rows.forEach((row, number) => one.y[row] !== null && found.push({ one, row, number, panel: at }));
    });
    return found;
  }

  function text(data, x, panel, { one, row, number }) {
    const half = one.spread?.[row];
    const lying = panel.names.length > 0;
    const bar = half === null || half === undefined ? "" : ` ± ${report.text(half, lying ? data.unit : panel.unit, 2)}`;
    const values = lying ? [`${data.label} ${report.text(x[row], data.unit)}${bar}`] : [
      `${panel.label} ${report.text(one.y[row], panel.unit)}${bar}`, `${data.label} ${report.text(x[row], data.unit)}`,
    ];
    return `${one.label}${one.notes[number] === "" ? "" : `, ${one.notes[number]}`}: ${values.join("; ")}`;
  }

  report.points = { prepare, joined, bars, nearest, all, text, inside };
})();
