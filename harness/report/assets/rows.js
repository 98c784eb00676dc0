// Panels whose ordinate is no quantity: rows with a name each, drawn above what belongs to it, so that any length fits.
(() => {
  const NAME = 0.37; // of a row, from its middle up to its name

  const ends = (panel) => [0.7 - panel.names.length, 0.62];

  const neutral = (log) => (log ? 1 : 0); // abscissa of the line across the rows

  // Abscissas that have to be seen: bars to their ends, and the line across where it is drawn.
  function covered(x, panel, log) {
    const found = panel.zero ? [neutral(log)] : [];
    for (const one of panel.series)
      (one.rows ?? []).forEach((row) => {
        const half = one.spread?.[row] ?? 0;
        found.push(x[row] - half, x[row] + half);
      });
    return found;
  }

  function draw(plot, panel, log) {
    const { ctx } = plot;
    const { left, top, width, height } = plot.bbox;
    ctx.save();
    ctx.fillStyle = report.theme.variable("--ink");
    const zero = plot.valToPos(neutral(log), "x", true);
    if (panel.zero && zero >= left && zero <= left + width)
      ctx.fillRect(zero - 0.4 * devicePixelRatio, top, 0.8 * devicePixelRatio, height);
    ctx.font = `${12 * devicePixelRatio}px system-ui`;
    ctx.textBaseline = "middle";
    ctx.textAlign = "left";
    ctx.setLineDash([]);
    ctx.lineWidth = 4 * devicePixelRatio;
    ctx.strokeStyle = report.theme.variable("--paper"); // around the letters, which lines cross otherwise
    panel.names.forEach((name, row) => {
      const place = [left + 4 * devicePixelRatio, plot.valToPos(NAME - row, "y", true)];
      ctx.strokeText(name, ...place);
      ctx.fillText(name, ...place);
    });
    ctx.restore();
  }

  report.rows = { ends, covered, draw, height: (panel) => panel.names.length * panel.tall + 20 };
})();
