// Data of the page: base64 to numbers, values between samples, numbers as text. All scripts share the object `report`.
const report = {};

(() => {
  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;

  // Little-endian floats as in harness/report/chart.py, on every processor.
  function floats(text, size) {
    const view = new DataView(bytes(text));
    const read = size === 8 ? (i) => view.getFloat64(8 * i, true) : (i) => view.getFloat32(4 * i, true);
    return Array.from({ length: view.byteLength / size }, (_, i) => read(i));
  }

  report.doubles = (text) => floats(text, 8);

  // What is NaN is a gap, null; what is −∞ is no sample, undefined: the line passes over.
  report.column = (text) =>
    floats(text, 4).map((value) => (Number.isNaN(value) ? null : value === -Infinity ? undefined : value));

  // Last row whose x is not larger; −1 before the first.
  report.rowAt = (x, at) => {
    let low = 0;
    let high = x.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (x[middle] <= at) low = middle + 1;
      else high = middle;
    }
    return low - 1;
  };

  // Value at `at`, linear between samples; null in a gap and outside.
  report.valueAt = (x, y, at) => {
    let before = report.rowAt(x, at);
    let after = before + 1;
    while (before >= 0 && y[before] === undefined) before -= 1;
    if (before < 0 || y[before] === null) return null;
    if (x[before] === at) return y[before];
    while (after < y.length && y[after] === undefined) after += 1;
    if (after >= y.length || y[after] === null) return null;
    const share = (at - x[before]) / (x[after] - x[before]);
    return y[before] + share * (y[after] - y[before]);
  };

  const RAISED = { ...Object.fromEntries([..."⁰¹²³⁴⁵⁶⁷⁸⁹"].map((raised, digit) => [digit, raised])), "-": "⁻" };

  // A number with `digits` significant ones, a true minus, and its unit, from which no line break parts it.
  report.text = (value, unit, digits = 4) => {
    if (value === null || value === undefined || !Number.isFinite(value)) return "—";
    const size = Math.abs(value);
    const plain = size === 0 || (size >= 1e-3 && size < 1e6);
    const rounded = Number(value.toPrecision(digits));
    const [front, power] = plain ? [String(rounded), ""] : rounded.toExponential().split("e");
    const tens = power === "" ? "" : "·10" + [...power.replace("+", "")].map((sign) => RAISED[sign]).join("");
    return (front + tens).replaceAll("-", "−") + (unit === "1" || unit === "" ? "" : "\u00a0" + unit);
  };

  // `u_val` with its index set low.
  report.symbols = (text) =>
    text.split(/(_val)/).map((part) => (part === "_val" ? report.make("sub", {}, "val") : part));

  report.make = (tag, attributes = {}, ...children) => {
    const space = report.make.svg.has(tag) ? "http://www.w3.org/2000/svg" : null;
    const element = space ? document.createElementNS(space, tag) : document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
      if (typeof value === "function") element.addEventListener(name, value);
      else if (value !== null && value !== false) element.setAttribute(name, value === true ? "" : value);
    }
    element.append(...children);
    return element;
  };
  report.make.svg = new Set(["svg", "g", "line", "circle", "rect", "path", "polygon", "polyline", "title"]);
})();
