// Marks of axes: where they are on a logarithmic one, and their texts.
(() => {
  const FEW = 2; // decades within which 2 and 5 have a mark, too

  // 1, 2, 5 of each decade; of many decades the powers of ten; within less than a decade, equal steps.
  function logarithmic(low, high) {
    const decades = Math.log10(high / low);
    if (decades < 0.9) {
      const rough = (high - low) / 5;
      const power = 10 ** Math.floor(Math.log10(rough));
      const step = [1, 2, 5, 10].map((one) => one * power).find((one) => one >= rough);
      const first = Math.ceil(low / step - 1e-9);
      return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, at) => (first + at) * step);
    }
    const marks = decades <= FEW ? [1, 2, 5] : [1];
    const each = decades > 8 ? 3 : 1;
    const found = [];
    for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1)
      for (const mark of marks) {
        const at = Number(`${mark}e${power}`);
        if (power % each === 0 && at >= low * (1 - 1e-9) && at <= high * (1 + 1e-9)) found.push(at);
      }
    return found;
  }

  report.axes = {
    logarithmic,
    texts: (_, values) => values.map((value) => (value === null ? null : report.text(value, "", 6))),
    log: { splits: (_plot, _axis, low, high) => logarithmic(low, high), filter: (_, values) => values },
  };
})();
