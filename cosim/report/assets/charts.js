// The interactive panels of a page: each section of class "charts" holds its numbers as JSON, and becomes panels
// over time whose zoom and cursor are linked. uPlot draws; every text from a file goes in as text, never as HTML.
"use strict";

(() => {
  const HEIGHT = 190, NARROW = 560; // px of a panel; below the second a page is narrow
  const FOUND = 12; // signals that a search shows
  const FONT = "12px system-ui, sans-serif";

  // ---- numbers

  /** Return the numbers of a packed column: deflated, of all numbers the first bytes first (columns.py). */
  async function unpacked(packed) {
    const text = atob(packed.data), deflated = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) deflated[i] = text.charCodeAt(i);
    const stream = new Blob([deflated]).stream().pipeThrough(new DecompressionStream("deflate"));
    const shuffled = new Uint8Array(await new Response(stream).arrayBuffer());
    const width = packed.type === "f8" ? 8 : 4, count = shuffled.length / width;
    const bytes = new Uint8Array(shuffled.length);
    for (let b = 0, k = 0; b < width; b++) for (let i = b; i < bytes.length; i += width) bytes[i] = shuffled[k++];
    return width === 8 ? new Float64Array(bytes.buffer, 0, count) : new Float32Array(bytes.buffer, 0, count);
  }

  /** Return the times of a grid, times `scale`: those of equal steps are counted as the run counts them. */
  async function timesOf(grid, scale) {
    const times = new Float64Array(grid.data ? await unpacked(grid) : grid.count);
    if (!grid.data) {
      for (let k = 0; k < times.length; k++) times[k] = (grid.first + k * grid.advance) / grid.divisor;
      times[times.length - 1] = grid.last;
    }
    return scale === 1 ? times : times.map(t => scale * t);
  }

  /** Return the last row whose time is `time` or before; -1 for none. */
  function rowBefore(times, time) {
    let low = 0, high = times.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] <= time) low = middle + 1; else high = middle;
    }
    return low - 1;
  }

  /** Return the row that shows at a time: of a held signal the last one, else the nearest; -1 outside all rows. */
  function rowAt(line, time) {
    const k = rowBefore(line.times, time), next = k + 1, count = line.times.length;
    if (k < 0 || (next === count && line.times[k] < time)) return -1;
    return !line.held && next < count && line.times[next] - time < time - line.times[k] ? next : k;
  }

  /** Return a number as people read it, with six digits. */
  function number(value) {
    if (!Number.isFinite(value)) return String(value);
    const size = Math.abs(value);
    return size !== 0 && (size < 1e-4 || size >= 1e7)
      ? value.toExponential(5).replace(/\.?0+e/, "e").replace("e+", "e")
      : String(Number(value.toPrecision(6)));
  }

  /** Return the text of a mark on an axis: all the digits that tell it from the next one. */
  function mark(value) {
    const size = Math.abs(value);
    return size !== 0 && (size < 1e-4 || size >= 1e7) ? number(value) : String(Number(value.toPrecision(12)));
  }

  /** Return the sorted times of several lines, and their values there; undefined where a line has no row. */
  function together(lines) {
    if (lines.every(line => line.times === lines[0].times)) return [lines[0].times, ...lines.map(l => l.values)];
    const all = Float64Array.from(new Set(lines.flatMap(line => Array.from(line.times)))).sort();
    const columns = lines.map(line => {
      const column = new Array(all.length);
      for (let i = 0, k = 0; i < all.length; i++) if (line.times[k] === all[i]) column[i] = line.values[k++];
      return column;
    });
    return [all, ...columns];
  }

  // ---- elements

  function element(tag, attributes = {}, ...inside) {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
      if (typeof value === "function") made.addEventListener(name, value); else made.setAttribute(name, value);
    }
    made.append(...inside);
    return made;
  }

  /** Return a short piece of a line in its color and dashes, for the key below a panel. */
  function sample(line) {
    const space = "http://www.w3.org/2000/svg";
    const svg = document.createElementNS(space, "svg"), stroke = document.createElementNS(space, "line");
    for (const [name, value] of [["width", 28], ["height", 10], ["aria-hidden", "true"]]) svg.setAttribute(name, value);
    const about = { x1: 0, x2: 28, y1: 5, y2: 5, stroke: line.color, "stroke-width": line.width,
      "stroke-dasharray": line.dash.join(" ") };
    for (const [name, value] of Object.entries(about)) stroke.setAttribute(name, value);
    svg.append(stroke);
    return svg;
  }

  /** Return a pale pattern of a state: hatched where the plain colors are used up. */
  function fillOf(context, color, hatched) {
    if (!hatched) return color;
    const tile = element("canvas", { width: 8, height: 8 }), brush = tile.getContext("2d");
    brush.fillStyle = color;
    brush.fillRect(0, 0, 8, 8);
    brush.strokeStyle = "#c0c0c0";
    brush.stroke(new Path2D("M-2 2 L2 -2 M0 8 L8 0 M6 10 L10 6"));
    return context.createPattern(tile, "repeat");
  }

  const stepped = uPlot.paths.stepped({ align: 1 }), linear = uPlot.paths.linear();

  /** Draw steps, or, where many rows fall on a pixel, their extremes, which look the same. */
  function steps(plot, series, first, last) {
    return (last - first > 4 * plot.bbox.width ? linear : stepped)(plot, series, first, last);
  }

  // ---- one panel

  class Panel {
    constructor(charts, about, lines, onRemove) {
      Object.assign(this, { charts, about, lines });
      this.scaleLines();
      this.values = lines.map(() => element("b"));
      this.plot = null;
      const unit = about.unit ? ` [${about.unit}]` : "";
      this.head = element("h3", {}, `${about.title}${unit}`.trim());
      if (onRemove) {
        this.head.append(element("button", { type: "button", click: onRemove, "aria-label": `remove ${about.title}` }, "×"));
      }
      if (about.about) this.head.append(element("small", {}, about.about));
      const keys = lines.map((line, i) =>
        element("button", { type: "button", class: "key", "aria-pressed": "true", click: () => this.toggle(i) },
          sample(line), element("span", {}, line.label), this.values[i]));
      this.keys = element("div", { class: "keys" }, ...keys);
      this.place = element("div", { class: "plot" });
      this.root = element("div", { class: "panel" }, this.head, this.place, this.keys);
    }

    /** Bring values that are very large or small near 1, which the axis labels undo: a canvas draws no 1e300. */
    scaleLines() {
      let most = 0;
      for (const { values } of this.lines) for (const v of values) if (v !== null && Math.abs(v) > most) most = Math.abs(v);
      const power = most > 0 ? Math.max(-300, Math.floor(Math.log10(most))) : 0;
      this.power = power > 9 || power < -6 ? power : 0;
      if (!this.power) return;
      const down = v => v === null ? null : v / 10 ** this.power;
      this.data = together(this.lines.map(line => ({ ...line, values: Array.from(line.values, down) })));
    }

    draw() {
      const { charts, about } = this, items = new Map(about.items);
      const label = v => items.size ? items.get(v) ?? "" : mark(v * 10 ** this.power);
      const axis = { font: FONT, stroke: "#404040", grid: { stroke: "#b0b0b060", width: 1 }, ticks: { stroke: "#b0b0b0", width: 1, size: 5 } };
      const options = {
        width: charts.width(), height: HEIGHT, legend: { show: false }, padding: [10, 12, 0, 0],
        scales: { x: { time: false, range: (_, low, high) => low < high ? [low, high] : [low - 0.5, high + 0.5] },
          y: { range: (_, low, high) => this.range(low, high) } },
        axes: [
          { ...axis, size: 30, space: 60, label: this.charts.timeLabel(this), labelSize: 16, labelGap: 0, labelFont: FONT, values: (_, splits) => splits.map(mark) },
          { ...axis, size: charts.axisWidth, space: 28,
            splits: items.size ? (_, __, low, high) => [...items.keys()].filter(v => low <= v && v <= high) : undefined,
            values: (_, splits) => splits.map(v => charts.fitting(label(v))) },
        ],
        series: [{}, ...this.lines.map(line => ({
          stroke: line.color, width: line.width, dash: line.dash.length ? line.dash : undefined,
          paths: line.held ? steps : linear, points: { show: line.times.length < 2, size: 6 },
        }))],
        cursor: { y: false, sync: { key: charts.key, setSeries: false }, points: { size: 7 },
          drag: { x: true, y: false, dist: 4 }, bind: { dblclick: () => () => charts.zoom(...charts.whole) } },
        hooks: {
          drawClear: [plot => charts.shade(plot)],
          draw: [plot => charts.mark(plot)],
          setScale: [(plot, scale) => scale === "x" && charts.zoom(plot.scales.x.min, plot.scales.x.max)],
          setCursor: [plot => plot.cursor.event && charts.point(plot)],
        },
      };
      this.plot = new uPlot(options, this.data ?? together(this.lines), this.place);
      this.plot.setScale("x", { min: charts.view[0], max: charts.view[1] });
    }

    /** Return the ends of the value axis: as given, or with room around what is in view. */
    range(low, high) {
      if (this.about.limits) return this.about.limits.map(v => v / 10 ** this.power);
      if (low === null || high === null) return [0, 1];
      if (this.about.items.length) return [low - 0.3, high + 0.3];
      const size = Math.max(Math.abs(low), Math.abs(high));
      const room = high - low > 1e-6 * size ? 0.07 * (high - low) : 0.1 * size || 1;
      return [low - room, high + room];
    }

    /** Write beside each line the value that it has at a time. */
    show(time) {
      this.lines.forEach((line, i) => {
        const k = rowAt(line, time), value = k < 0 ? null : line.values[k];
        const name = new Map(this.about.items).get(value);
        const unit = this.about.unit ? ` ${this.about.unit}` : "";
        this.values[i].textContent = value === null ? "-" : name ?? `${number(value)}${unit}`;
      });
    }

    toggle(i) {
      const shown = !this.plot.series[i + 1].show;
      this.plot.setSeries(i + 1, { show: shown });
      this.keys.children[i].setAttribute("aria-pressed", String(shown));
    }
  }

  // ---- all panels of a section

  let sections = 0;

  class Charts {
    constructor(root, data) {
      Object.assign(this, { root, data, panels: [], grids: new Map(), columns: new Map() });
      this.key = `charts ${++sections}`;
      const { begin, end, shown } = data.time;
      this.whole = begin < end ? [begin, end] : [begin - 0.5, end + 0.5];
      this.view = shown[0] < shown[1] ? shown : this.whole;
    }

    async start() {
      this.measure();
      this.at = element("output", {});
      this.stack = element("div", { class: "stack" });
      this.root.prepend(this.bar(), this.stack);
      for (const about of this.data.panels) await this.add(about);
      this.rest();
      this.root.addEventListener("mouseleave", () => this.rest());
      new ResizeObserver(() => this.resize()).observe(this.root);
    }

    /** Return the width [px] of a panel. */
    width() {
      return Math.max(200, Math.floor(this.stack.getBoundingClientRect().width));
    }

    /** Choose one width for the axes of all panels, so that one time is at one place in all of them. */
    measure() {
      this.pen = document.createElement("canvas").getContext("2d");
      this.pen.font = FONT;
      const names = this.data.panels.flatMap(panel => panel.items.map(([, name]) => name));
      const widest = Math.max(40, ...names.map(name => this.pen.measureText(name).width));
      this.axisWidth = Math.min(window.innerWidth < NARROW ? 72 : 130, Math.ceil(widest) + 16);
    }

    /** Return the text below the time axis of a panel: the last one of the figure, and those that were added. */
    timeLabel(panel) {
      return this.panels.indexOf(panel) < this.data.panels.length - 1 ? undefined : `time [${this.data.time.unit}]`;
    }

    /** Return a text that fits beside a value axis. */
    fitting(text) {
      const room = this.axisWidth - 12;
      if (this.pen.measureText(text).width <= room) return text;
      let end = text.length;
      while (end > 1 && this.pen.measureText(`${text.slice(0, end)}…`).width > room) end--;
      return `${text.slice(0, end)}…`;
    }

    // ---- data

    /** Return a promise of a line with its times and values, in the unit of its panel. */
    async line(about) {
      const packed = this.data.columns[about.column], { scale, offset } = about;
      const once = (cache, key, make) => cache.get(key) ?? cache.set(key, make()).get(key);
      const times = await once(this.grids, packed.grid, () => timesOf(this.data.grids[packed.grid], this.data.time.scale));
      let values = await once(this.columns, about.column, () => unpacked(packed));
      if (scale !== 1 || offset !== 0) values = Float64Array.from(values, v => scale * v + offset);
      if (packed.gaps || !values.every(Number.isFinite)) values = Array.from(values, v => Number.isFinite(v) ? v : null);
      return { ...about, times, values };
    }

    async add(about, removable = false) {
      const lines = await Promise.all(about.lines.map(line => this.line(line)));
      const panel = new Panel(this, about, lines, removable ? () => this.remove(panel) : null);
      this.panels.push(panel);
      this.stack.append(panel.root);
      panel.draw();
      panel.show(this.time ?? this.view[1]);
      return panel;
    }

    remove(panel) {
      this.panels.splice(this.panels.indexOf(panel), 1);
      panel.plot.destroy();
      panel.root.remove();
    }

    // ---- what all panels have in common

    /** Show the part of the time from `low` to `high` in every panel. */
    zoom(low, high) {
      if (low === this.view[0] && high === this.view[1]) return;
      this.view = [low, high];
      for (const { plot } of this.panels) {
        if (plot && (plot.scales.x.min !== low || plot.scales.x.max !== high)) plot.setScale("x", { min: low, max: high });
      }
      this.rest();
    }

    /** Zoom to `size` times the view, moved by `way` of its length, within the run. */
    move(size, way) {
      const [low, high] = this.view, [begin, end] = this.whole;
      const length = Math.min(end - begin, size * (high - low));
      const middle = (low + high) / 2 + way * length;
      const from = Math.min(Math.max(begin, middle - length / 2), end - length);
      this.zoom(from, from + length);
    }

    /** Show the values of the row under the cursor. */
    point(plot) {
      if (plot.cursor.left < 0 || plot.cursor.idx === null) return this.rest();
      this.show(plot.data[0][plot.cursor.idx]);
    }

    /** Show the values at the end of what is in view: the last ones that all curves have which reach into it. */
    rest() {
      const ends = this.panels.flatMap(p => p.lines.map(l => l.times[l.times.length - 1])).filter(t => t >= this.view[0]);
      this.show(Math.min(this.view[1], this.data.time.end, ...ends));
    }

    show(time) {
      this.time = time;
      const { states, time: { unit } } = this.data;
      const parts = [`t = ${number(time)} ${unit}`];
      if (states) {
        const k = Math.min(rowBefore(this.stateTimes(), time), states.values.length - 1);
        const item = states.items.find(([value]) => value === states.values[k]);
        if (item) parts.push(item[1]);
      }
      this.at.textContent = parts.join(" · ");
      for (const panel of this.panels) panel.show(time);
    }

    stateTimes() {
      return this.scaledStates ??= this.data.states.times.map(t => t * this.data.time.scale);
    }

    /** Shade what is behind the curves of a panel by the states. */
    shade(plot) {
      const { states } = this.data;
      if (!states) return;
      const { ctx, bbox } = plot, times = this.stateTimes();
      const fills = new Map(states.items.map(([value, , color, hatched]) => [value, fillOf(ctx, color, hatched)]));
      ctx.save();
      for (let k = 0; k + 1 < times.length; k++) {
        if (times[k + 1] < this.view[0] || times[k] > this.view[1] || !fills.has(states.values[k])) continue;
        const from = Math.max(bbox.left, plot.valToPos(times[k], "x", true));
        const to = Math.min(bbox.left + bbox.width, plot.valToPos(times[k + 1], "x", true));
        ctx.fillStyle = fills.get(states.values[k]);
        ctx.fillRect(from, bbox.top, to - from, bbox.height);
      }
      ctx.restore();
    }

    /** Draw a numbered mark at each event. */
    mark(plot) {
      const { ctx, bbox } = plot, ratio = devicePixelRatio;
      ctx.save();
      ctx.strokeStyle = ctx.fillStyle = "#8b0000";
      ctx.font = `${11 * ratio}px system-ui, sans-serif`;
      ctx.setLineDash([2 * ratio, 3 * ratio]);
      this.data.events.forEach(({ time }, i) => {
        const x = plot.valToPos(time * this.data.time.scale, "x", true);
        if (x < bbox.left || x > bbox.left + bbox.width) return;
        ctx.stroke(new Path2D(`M${x} ${bbox.top} V${bbox.top + bbox.height}`));
        ctx.fillText(String(i + 1), x + 2 * ratio, bbox.top + 9 * ratio);
      });
      ctx.restore();
    }

    resize() {
      const width = this.width();
      for (const { plot } of this.panels) if (plot.width !== width) plot.setSize({ width, height: HEIGHT });
    }

    // ---- controls

    /** Return the bar above the panels: time and state under the cursor, zoom, states, events, search. */
    bar() {
      const button = (text, about, click) => element("button", { type: "button", title: about, "aria-label": about, click }, text);
      const zoom = element("span", { class: "zoom" },
        button("−", "zoom out", () => this.move(2, 0)), button("+", "zoom in", () => this.move(0.5, 0)),
        button("◀", "earlier", () => this.move(1, -0.25)), button("▶", "later", () => this.move(1, 0.25)),
        button("all", "the whole run", () => this.zoom(...this.whole)));
      const bar = element("div", { class: "bar" }, this.at, zoom, ...this.search());
      const { states, events } = this.data, parts = [bar];
      if (states) {
        const keys = states.items.map(([, name, color, hatched]) =>
          element("li", {}, element("i", { class: hatched ? "state hatched" : "state", style: `background-color: ${color}` }), name));
        parts.push(element("ul", { class: "states" }, element("li", {}, `${states.name}:`), ...keys));
      }
      if (events.length) {
        const { scale, unit } = this.data.time;
        parts.push(element("ol", { class: "events" }, ...events.map(e => element("li", {}, `${number(e.time * scale)} ${unit}: ${e.text}`))));
      }
      const fragment = document.createDocumentFragment();
      fragment.append(...parts);
      return fragment;
    }

    search() {
      if (!this.data.signals.length) return [];
      const words = signal => `${signal.title} ${signal.unit} ${signal.about ?? ""}`.toLowerCase();
      const known = this.data.signals.map(signal => [words(signal), signal]);
      const list = element("ul", { class: "found", hidden: "" });
      const input = element("input", { type: "search", placeholder: `search ${known.length} signal${known.length === 1 ? "" : "s"} to show`, "aria-label": "show another signal",
        autocomplete: "off" });
      const choose = signal => {
        list.hidden = true;
        input.value = "";
        this.add(signal, true).then(panel => panel.root.scrollIntoView({ block: "nearest" }));
      };
      const find = () => {
        const wanted = input.value.toLowerCase().split(/\s+/);
        const fits = known.filter(([text]) => wanted.every(word => text.includes(word))).map(([, signal]) => signal);
        const rows = fits.slice(0, FOUND).map(signal => element("li", {},
          element("button", { type: "button", click: () => choose(signal) }, signal.unit ? `${signal.title} [${signal.unit}]` : signal.title,
            element("small", {}, signal.about ?? ""))));
        const more = fits.length > FOUND ? [element("li", {}, `and ${fits.length - FOUND} more`)] : [];
        list.replaceChildren(...rows, ...more, ...(fits.length ? [] : [element("li", {}, "no such signal")]));
        list.hidden = false;
        return fits;
      };
      const box = element("span", { class: "search",
        focusout: event => { if (!box.contains(event.relatedTarget)) list.hidden = true; },
        keydown: event => { if (event.key === "Escape") list.hidden = true; } }, input, list);
      for (const kind of ["input", "focus"]) input.addEventListener(kind, find);
      input.addEventListener("keydown", event => {
        const fits = event.key === "Enter" ? find() : [];
        if (fits.length) choose(fits[0]);
      });
      return [box];
    }
  }

  async function start(root) {
    const wait = root.querySelector(".wait");
    try {
      const charts = root.charts = new Charts(root, JSON.parse(root.querySelector("script").textContent));
      await charts.start();
      wait.remove();
      root.dataset.ready = "true";
    } catch (error) {
      wait.textContent = `The curves cannot be drawn: ${error.message}. A browser of 2023 or later is needed.`;
      console.error(error);
    }
  }

  document.querySelectorAll("section.charts").forEach(start);
})();
