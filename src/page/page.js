// Brings the page of `flexlink report` to life. All but the animation is on the page without it.
"use strict";
const root = document.documentElement;
root.classList.add("js");

const set = (node, attributes) => {
	for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
	return node;
};
const el = (tag, attributes, ...children) => {
	const node = set(document.createElement(tag), attributes);
	node.append(...children);
	return node;
};
const div = (className, ...children) => el("div", { class: className }, ...children);
const svg = (tag, className, attributes = {}) =>
	set(document.createElementNS("http://www.w3.org/2000/svg", tag), { class: className, ...attributes });
const upright = (line, x) => set(line, { x1: x, x2: x });
const clamp = (v, lo, hi) => Math.min(Math.max(v, lo), hi);
const mix = (a, b, s) => a + (b - a) * s;
const numbersIn = (text) => text.trim().split(/[\s,]+/).map(Number);
const least = (list, of) => list.reduce((best, v) => (of(v) < of(best) ? v : best));
const nearest = (list, v) => least([...list.keys()], (i) => Math.abs(list[i] - v));

// As many decimals as tell `step` apart, always the same so that numbers do not jump about.
const number = (v, step) => {
	const decimals = Math.max(0, Math.ceil(-Math.log10(step) - 1e-6));
	const text = decimals > 6 || Math.abs(v) >= 1e6 ? v.toExponential(3) : v.toFixed(decimals);
	return text.replace(/^-(?=[0.]+(e|$))/, "").replaceAll("-", "−");
};
const niceStep = (raw) => {
	const power = 10 ** Math.floor(Math.log10(raw));
	return power * [1, 2, 5, 10].find((m) => m * power >= raw * 0.9999);
};

const motionData = document.getElementById("motion");
const motion = motionData && JSON.parse(motionData.textContent);
let seek = () => {}; // the animation sets it, to show the link at a time

const themeButton = document.getElementById("theme");
const next = { auto: "light", light: "dark", dark: "auto" };
const showTheme = (theme) => {
	root.dataset.theme = theme in next ? theme : "auto";
	themeButton.textContent = `Theme: ${root.dataset.theme}`;
};
let theme = "auto";
// A page opened from disk may be refused the storage: the theme is then kept for this visit.
try { theme = localStorage["flexlink-theme"]; } catch {}
showTheme(theme);
themeButton.hidden = false;
themeButton.onclick = () => {
	showTheme(next[root.dataset.theme]);
	try { localStorage["flexlink-theme"] = root.dataset.theme; } catch {}
};

// What scrolls sideways must be in reach of the keyboard. On a narrow page a table that is too wide is a list instead: of
// each row its cells below each other, with their headings.
const tables = [...document.querySelectorAll(".scroll")], narrow = matchMedia("(max-width: 560px)");
for (const box of tables) {
	set(box, { tabindex: 0, role: "group", "aria-label": "Table" });
	const headings = [...box.querySelectorAll("thead th")].map((cell) => cell.textContent);
	for (const { cells } of box.querySelectorAll("tbody tr")) {
		let column = 0;
		for (const cell of cells) {
			cell.dataset.heading = headings[column];
			column += cell.colSpan;
		}
	}
}
const stackTables = () => {
	for (const box of tables) box.classList.remove("stacked");
	for (const box of tables) box.classList.toggle("stacked", narrow.matches && box.scrollWidth > box.clientWidth);
};
addEventListener("resize", stackTables);
document.addEventListener("toggle", stackTables, true); // what is folded has no width
stackTables();

// Gives the reader a file.
function download(name, blob) {
	const link = el("a", { href: URL.createObjectURL(blob), download: name });
	link.click();
	setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
const inUnit = (name, unit) => (unit ? `${name} in ${unit}` : name);
const csvOf = (rows) => rows.map((row) => row.map((cell) => (/[",\n]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell)).join(",")).join("\n") + "\n";

// A figure as it was written, on white, two pixels for each of its units.
async function pictureOf(chart) {
	const [, , width, height] = numbersIn(chart.getAttribute("viewBox"));
	const style = document.createElementNS("http://www.w3.org/2000/svg", "style");
	style.textContent = document.getElementById("figure-style").textContent;
	chart.prepend(style, svg("rect", "", { width, height, fill: "#fff" }));
	set(chart, { width: 2 * width, height: 2 * height });
	const address = URL.createObjectURL(new Blob([new XMLSerializer().serializeToString(chart)], { type: "image/svg+xml" }));
	const image = el("img", { src: address });
	await image.decode();
	URL.revokeObjectURL(address);
	const canvas = el("canvas", { width: 2 * width, height: 2 * height });
	canvas.getContext("2d").drawImage(image, 0, 0);
	return new Promise((done) => { canvas.toBlob(done); });
}

// ---- Figures

// The points of a path, in units of the plot. NaN parts its pieces: in a gap nothing is read.
function pointsOf(path) {
	const xs = [], ys = [];
	for (const [, command, x, y] of path.getAttribute("d").matchAll(/([ML])([-\d.e]+),([-\d.e]+)/g)) {
		if (command === "M" && xs.length) { xs.push(+x); ys.push(NaN); }
		xs.push(+x);
		ys.push(+y);
	}
	return { xs, ys };
}

// The height of a line at u, between its points.
function heightAt({ xs, ys }, u) {
	const slack = 0.02; // coordinates are rounded
	if (!(u >= xs[0] - slack && u <= xs.at(-1) + slack)) return NaN;
	const i = Math.max(0, xs.findLastIndex((x) => x <= u + 1e-6)), past = u - xs[i];
	return past < 1e-6 || i + 1 === xs.length ? ys[i] : mix(ys[i], ys[i + 1], past / (xs[i + 1] - xs[i]));
}

// The heights of a line at u: of single dots those of all that stand there, of any other the one between its points.
function heightsAt({ look, points }, u) {
	const all = look.endsWith("points") ? points.ys.filter((_, i) => Math.abs(points.xs[i] - u) < 0.02) : [heightAt(points, u)];
	return all.filter((y) => y === y);
}

// An axis runs evenly over scaled values (log10 on a log axis), from 0 to `length` units of the plot.
function axisOf(node, letter, length) {
	const data = (name) => node.getAttribute(`data-${letter}${name}`) || "";
	const log = data("-scale") === "log";
	const scale = (v) => (log ? Math.log10(v) : v), value = (s) => (log ? 10 ** s : s);
	const [from, to] = numbersIn(data("")).map(scale);
	const read = (s, size = to - from) =>
		`${number(value(s), log ? value(s) / 1000 : size / 2000)} ${data("-unit") || node.dataset.unit || ""}`.trim();
	const toUnits = (s) => ((s - from) / (to - from)) * length, toScaled = (u) => mix(from, to, u / length);
	const places = data("-places") && numbersIn(data("-places"));
	// For a file: to a millionth of the axis, as the lines are drawn.
	const exact = (v) => (log ? +v.toPrecision(6) : +v.toFixed(clamp(6 - Math.floor(Math.log10(to - from)), 0, 100)));
	const name = data("-name") || letter, unit = data("-unit") || node.dataset.unit || "";
	return { log, scale, value, from, to, read, toUnits, toScaled, exact, places, name, unit };
}

// Ticks [scaled value, text] within a … b, as many as there is room for.
function ticksOf({ log, scale, value, places }, a, b, room) {
	const ticks = [];
	if (places) {
		for (const place of places) ticks.push([scale(place), `${+place.toPrecision(4)}`]);
	} else if (log && b - a > 1) {
		const parts = room / (b - a) > 3 ? [1, 2, 5] : [1], every = Math.ceil((b - a) / room);
		for (let power = Math.floor(a); power <= b; power += every)
			for (const m of parts) ticks.push([power + Math.log10(m), `${+(m * 10 ** power).toPrecision(2)}`]);
	} else {
		const step = niceStep((value(b) - value(a)) / room);
		for (let i = Math.floor(value(a) / step); i * step <= value(b) + step; i++)
			ticks.push([scale(i * step), number(i * step, step)]);
	}
	const slack = (b - a) * 1e-6;
	return ticks.filter(([s]) => s >= a - slack && s <= b + slack);
}

// An entry of a key: a sample of the look, the name, and room for a value.
function keyEntry(look, name, ...value) {
	if (!look) return el("span", {}, name, ...value);
	const box = "M1,1H25V11H1Z", d = /hatched/.test(look) ? `${box}M4,11L14,1M12,11L22,1` : /span|fill/.test(look) ? box : "M1,6H25";
	const sample = svg("svg", "", { viewBox: "0 0 26 12", "aria-hidden": true });
	sample.append(svg("path", look, { d }));
	return el("span", {}, sample, el("span", {}, name), ...value);
}

// Figures over time share window and cursor (scaled values); any other has its own.
const newGroup = () => ({ charts: [], window: null, cursor: NaN, now: NaN });
const timeGroup = newGroup();

function bringToLife(figure) {
	const chart = figure.querySelector("svg.chart"), plot = chart?.querySelector("svg.plot");
	if (!plot) return;
	const find = (selector) => chart.querySelector(selector), original = chart.cloneNode(true);
	const [left, top, width, height] = numbersIn(chart.dataset.plot);
	const [, , fullWidth, fullHeight] = numbersIn(chart.getAttribute("viewBox"));
	const X = axisOf(chart, "x", width);
	// A y axis counts downward in its band of the plot; a line above a map has its own.
	const upAxisOf = (node) => {
		const [above, band] = numbersIn(node.dataset.band || `0 ${height}`), foot = above + band, axis = axisOf(node, "y", band);
		return { ...axis, toUnits: (s) => foot - axis.toUnits(s), toScaled: (u) => axis.toScaled(foot - u) };
	};
	const Y = upAxisOf(chart);
	const isTime = chart.dataset.xAxis === "time", group = isTime ? timeGroup : newGroup();
	const map = find("image"), zoomed = find(".zoom"), ticks = find(".ticks.x");

	const series = [...zoomed.querySelectorAll(".line")].map((path) => ({
		name: path.dataset.name, look: path.getAttribute("class"), points: pointsOf(path),
		axis: path.dataset.y ? upAxisOf(path) : Y,
	}));
	const isOfDots = series.length > 0 && series.every(({ look }) => look.endsWith("points")) && !find(".bars.broad");
	// Between dots, which are single cases, nothing is known: the cursor goes from one to the next.
	const stops = [...new Set([...zoomed.querySelectorAll(".dots")].flatMap((path) => pointsOf(path).xs))].sort((a, b) => a - b);

	// -- What is added: a key with values, buttons, and over the plot a slider that reads it

	const key = div("key"), values = [];
	const addValue = (look, name) => {
		const value = el("span", { class: "value" });
		key.append(keyEntry(look, name, " ", value));
		values.push(value);
		return value;
	};
	const atX = addValue("", X.name), atY = map && addValue("", Y.name);
	// A map over time shows what the page holds of every node of its link: moments, or deflections without them.
	const link = motion?.links[(figure.id.match(/\d+$/) || [1])[0] - 1];
	const [bending, unit] = link?.moment_n_m ? [link.moment_n_m, "N m"] : [link?.deflection_m, "m"];
	const bent = map && isTime && bending && addValue("", unit === "m" ? "deflection" : "bending moment");
	// The drawn points, each line a column; of a map over time its nodes, of another its fields.
	const [start, step] = numbersIn(chart.dataset.xGrid || "0 0");
	const timeOf = (v) => +(start + Math.round((v - start) / step) * step).toPrecision(9);
	const rowsOfFigure = () => {
		if (bent) {
			const head = link.nodes_m.map((x) => inUnit(`${unit === "m" ? "deflection" : "moment"} at x = ${x} m`, unit));
			return [[inUnit(X.name, X.unit), ...head], ...motion.times_s.map((t, i) => [t, ...bending[i]])];
		}
		if (map) return [...figure.querySelectorAll(".numbers tr")].map(({ cells }) => [...cells].map((cell) => cell.textContent.replaceAll("−", "-")));
		// Several dots may stand over one x: each is a row. The same as Figure::table_of_dots.
		if (isOfDots) {
			const dots = series.flatMap(({ name, points: { xs, ys } }) => xs.map((u, i) => [u, ys[i], name]).filter(([, y]) => y === y));
			const cellsOf = (cells) => cells.slice(0, series.length > 1 ? 3 : 2);
			const row = ([u, y, name]) => cellsOf([X.exact(X.value(X.toScaled(u))), Y.exact(Y.value(Y.toScaled(y))), name]);
			return [cellsOf([inUnit(X.name, X.unit), inUnit(Y.name, Y.unit), "case"]), ...dots.sort(([a], [b]) => a - b).map(row)];
		}
		const rows = new Map();
		series.forEach(({ points: { xs, ys }, axis }, column) => xs.forEach((u, i) => {
			if (ys[i] !== ys[i]) return;
			const at = X.value(X.toScaled(u)), x = step ? timeOf(at) : X.exact(at);
			if (!rows.has(x)) rows.set(x, series.map(() => ""));
			rows.get(x)[column] = axis.exact(axis.value(axis.toScaled(ys[i])));
		}));
		const head = [inUnit(X.name, X.unit), ...series.map((one) => inUnit(one.name, one.axis.unit))];
		return [head, ...[...rows].sort(([a], [b]) => a - b).map(([x, values]) => [x, ...values])];
	};
	const file = figure.id.replace("fig-", ""), title = figure.querySelector("h3").textContent;
	const files = {
		CSV: () => download(`${file}.csv`, new Blob([csvOf(rowsOfFigure())], { type: "text/csv" })),
		PNG: async () => download(`${file}.png`, await pictureOf(original.cloneNode(true))),
	};
	figure.append(div("files", ...Object.entries(files).map(([name, onclick]) =>
		Object.assign(el("button", { type: "button", "aria-label": `${name}: ${title}` }, name), { onclick }))));
	const peakBending = bent && Math.max(...bending.map((frame) => Math.max(...frame.map(Math.abs))));
	for (const one of series) one.value = addValue(one.look, one.name);
	// The key takes the place of the legend, with what that says of shaded spans and areas.
	for (const text of chart.querySelectorAll(map ? ".legend .named + text" : ".legend text"))
		if (!series.some((one) => one.name === text.textContent))
			key.append(keyEntry(text.previousElementSibling?.getAttribute("class"), text.textContent));
	const [wider, closer, reset] = ["Zoom out", "Zoom in", "Reset zoom"].map((text) => el("button", { type: "button" }, text));
	const selection = div("selection");
	selection.hidden = true;
	const reader = set(div("reader", selection), {
		tabindex: 0, role: "slider", "aria-label": `Values: ${figure.querySelector("h3").textContent}`, "aria-valuetext": "none read",
		"aria-valuemin": X.value(X.from), "aria-valuemax": X.value(X.to), "aria-valuenow": X.value(X.from),
	});
	reader.style.inset = `${top}px ${fullWidth - left - width}px ${fullHeight - top - height}px ${left}px`;
	const frame = div("frame");
	chart.before(div("tools", wider, closer, reset), key, frame);
	frame.append(chart, reader);

	const now = svg("line", "now", { y2: height }), cursor = svg("g", "cursor");
	const atCursor = svg("line", "", { y2: height }), level = svg("line", "", { x2: width });
	for (const one of series) one.dot = svg("path", one.look.match(/s\d/)?.[0] || "s6");
	cursor.append(atCursor, ...(map ? [level] : []), ...series.map((one) => one.dot));
	plot.append(now, cursor);

	// -- Fit: the plot is stretched to the room, while text and strokes keep their size

	const tickForms = ["line", "text"].map((tag) => ticks.querySelector(tag));
	let shownWidth = width, row = mix(Y.from, Y.to, 0.5);

	const paper = matchMedia("print");
	const fit = () => { // on paper the figure is as it was written, legend included
		const outer = paper.matches ? fullWidth : Math.max(240, frame.clientWidth), grown = outer - fullWidth;
		shownWidth = width + grown;
		set(chart, { viewBox: `0 0 ${outer} ${fullHeight}` });
		for (const node of [plot, find(".plot-area")]) set(node, { width: shownWidth });
		for (const line of chart.querySelectorAll(".grid line, .ticks.y line")) set(line, { x2: left + shownWidth });
		// With the scale of a map, at the right edge, and smaller where there is no room.
		Object.assign(find(".legend").style, { translate: `${grown}px`, scale: Math.min(1, outer / 380), transformOrigin: `${fullWidth}px 17px` });
		set(find(".axis.x"), { x: left + shownWidth / 2 });
		draw();
	};

	const shown = () => group.window || [X.from, X.to];
	const share = (s, [a, b] = shown()) => (s - a) / (b - a); // of the width: where a scaled value lies
	const isIn = (part) => part >= 0 && part <= 1;
	const setIn = (node, part) => set(node, { visibility: isIn(part) ? "visible" : "hidden" });

	const draw = () => {
		const [a, b] = shown(), stretch = (X.to - X.from) / (b - a);
		set(zoomed, { transform: `translate(${-X.toUnits(a) * stretch} 0) scale(${stretch} 1)` });
		reset.hidden = !group.window;
		ticks.replaceChildren(...ticksOf(X, a, b, clamp(shownWidth / 44, 3, 10)).flatMap(([s, text]) => {
			const x = left + share(s) * shownWidth, nodes = tickForms.map((form) => set(upright(form.cloneNode(), x), { x }));
			nodes[1].textContent = text;
			return nodes;
		}));
		for (const text of chart.querySelectorAll(".fields text")) {
			const ends = [text.dataset.from, text.dataset.to].map((u) => clamp(share(X.toScaled(+u)), 0, 1) * shownWidth);
			set(text, { x: left + (ends[0] + ends[1]) / 2, visibility: ends[1] - ends[0] > text.getComputedTextLength() + 2 ? "visible" : "hidden" });
		}
		const free = {}; // of each row of names, where the last one ends
		for (const mark of chart.querySelectorAll("[data-at]")) {
			const part = share(X.scale(+mark.dataset.at));
			if (mark.tagName === "line") {
				upright(mark, part * width);
				continue;
			}
			const at = left + part * shownWidth, long = mark.getComputedTextLength() + 6, row = mark.getAttribute("y");
			const x = at + long < left + shownWidth ? at + 3 : at - long, fits = isIn(part) && x >= (free[row] ?? 0);
			set(mark, { x, visibility: fits ? "visible" : "hidden" });
			if (fits) free[row] = x + long;
		}
		drawNow();
		drawCursor();
	};

	const drawNow = () => {
		const part = share(group.now);
		if (isIn(part)) upright(now, part * width);
		setIn(now, part);
	};

	const drawCursor = () => {
		const s = group.cursor, part = share(s), x = part * width, [a, b] = shown();
		setIn(cursor, part);
		if (!isIn(part)) {
			for (const value of values) value.textContent = "";
			return;
		}
		upright(atCursor, x);
		atX.textContent = X.read(s, b - a);
		for (const one of series) {
			const all = heightsAt(one, X.toUnits(s)).sort((a, b) => b - a), ends = all.length > 1 ? [all[0], all.at(-1)] : all;
			one.value.textContent = ends.map((y) => one.axis.read(one.axis.toScaled(y))).join(" … ") || "none";
			set(one.dot, { d: all.map((y) => `M${x},${y}h0`).join("") });
		}
		if (map) {
			const y = Y.toUnits(row);
			set(level, { y1: y, y2: y });
			atY.textContent = Y.read(row);
		}
		if (bent) {
			const here = bending[nearest(motion.times_s, s)][nearest(link.nodes_m, row)];
			bent.textContent = `${number(here, peakBending / 2000 || 1)} ${unit}`;
		}
		const said = values.map((value) => value.parentNode.textContent).join(", ");
		set(reader, { "aria-valuenow": X.value(s), "aria-valuetext": said });
	};

	// -- Reading and zooming

	const setCursor = (s) => {
		group.cursor = s;
		for (const one of group.charts) one.drawCursor();
	};
	const setWindow = (a, b) => {
		const full = X.to - X.from, size = clamp(b - a, full / 500, full);
		const from = clamp((a + b - size) / 2, X.from, X.to - size);
		group.window = size > full * 0.999 ? null : [from, from + size];
		for (const one of group.charts) one.draw();
	};
	const resetZoom = () => setWindow(X.from, X.to);
	const here = () => (isIn(share(group.cursor)) ? group.cursor : mix(...shown(), 0.5));
	const zoom = (factor, s = here()) => setWindow(...shown().map((edge) => mix(s, edge, factor)));
	const snap = (s) => (stops.length ? X.toScaled(stops[nearest(stops, X.toUnits(s))]) : s);
	const under = (event) => {
		const box = reader.getBoundingClientRect();
		row = clamp(Y.toScaled((height * (event.clientY - box.top)) / box.height), Y.from, Y.to);
		return mix(...shown(), clamp((event.clientX - box.left) / box.width, 0, 1));
	};

	let drag = null; // where a drag began
	reader.onpointerdown = (event) => {
		const s = under(event);
		setCursor(snap(s));
		drag = event.button ? null : { x: event.clientX, s };
		if (event.pointerType !== "touch") reader.setPointerCapture(event.pointerId);
	};
	reader.onpointermove = (event) => {
		setCursor(snap(under(event)));
		// A finger reads only: it has buttons to zoom with.
		if (!drag || event.pointerType === "touch" || Math.abs(event.clientX - drag.x) < 5) return;
		const [from, to] = [share(drag.s), share(under(event))].sort((a, b) => a - b);
		selection.style.inset = `0 ${100 - to * 100}% 0 ${from * 100}%`;
		selection.hidden = false;
	};
	reader.onpointerup = (event) => {
		const to = under(event);
		if (!selection.hidden) setWindow(Math.min(drag.s, to), Math.max(drag.s, to));
		else if (drag && isTime) seek(to);
		drag = null;
		selection.hidden = true;
	};
	reader.onpointerleave = (event) => {
		if (event.pointerType !== "touch" && !reader.matches(":focus-visible")) setCursor(NaN);
	};
	reader.onfocus = () => reader.matches(":focus-visible") && setCursor(snap(here()));
	reader.onblur = ({ relatedTarget }) => relatedTarget?.closest("figure.chart") || setCursor(NaN);
	reader.ondblclick = resetZoom;
	reader.onwheel = (event) => {
		if (!event.ctrlKey) return;
		event.preventDefault();
		zoom(2 ** clamp(event.deltaY / 200, -1, 1), under(event));
	};
	reset.onclick = () => { resetZoom(); reader.focus(); };
	closer.onclick = () => zoom(0.5);
	wider.onclick = () => zoom(2);

	const move = (steps) => {
		const [a, b] = shown(), from = here();
		let s = clamp(from + steps * niceStep((b - a) / 300), X.from, X.to);
		if (stops.length) s = X.toScaled(stops[clamp(nearest(stops, X.toUnits(from)) + steps, 0, stops.length - 1)]);
		if (group.window && (s < a || s > b)) setWindow(a + s - from, b + s - from); // it follows the cursor
		setCursor(s);
	};
	const moveRow = (part) => {
		row = clamp(row + part * (Y.to - Y.from), Y.from, Y.to);
		drawCursor();
	};
	reader.onkeydown = (event) => {
		const step = event.shiftKey ? 20 : 1;
		const action = {
			ArrowLeft: () => move(-step), ArrowRight: () => move(step), Home: () => move(-1e9), End: () => move(1e9),
			"+": closer.onclick, "=": closer.onclick, "-": wider.onclick, 0: resetZoom, Escape: resetZoom,
			...(map && { ArrowUp: () => moveRow(step / 50), ArrowDown: () => moveRow(-step / 50) }),
		}[event.key];
		if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
		event.preventDefault();
		action();
	};

	group.charts.push({ draw, drawNow, drawCursor });
	paper.addEventListener("change", fit);
	addEventListener("resize", fit);
	fit();
}
document.querySelectorAll("figure.chart").forEach(bringToLife);

// ---- The link in motion

// The link, or the links of an arm, one on the tip of another. Each has a frame of its own: x from its joint, along the
// tangent at the hub or, in an arm, along the chord; w to the left.
function animate(stage, controls, caption) {
	const { times_s: times, links, wanted_m: wanted, base_m: base } = motion, isArm = links.length > 1;
	// A carriage slides on a rail below its link; its position is in place of the angle.
	const { slides } = links[0];
	const start = times[0], end = times.at(-1), count = times.length;
	const reduced = matchMedia("(prefers-reduced-motion: reduce)");

	// -- Controls

	let factor = motion.exaggeration, speed = 0.25;
	const play = el("button", { type: "button" }), clock = el("output", {});
	const slider = el("input", { type: "range", min: start, max: end, step: (end - start) / (count - 1), "aria-label": "Time" });
	const choice = (label, values, text, chosen, change) => {
		const box = el("select", {}, ...values.map((v) => el("option", { value: v }, text(v))));
		box.value = chosen;
		box.onchange = () => change(+box.value);
		return el("label", {}, label, box);
	};
	controls.append(play, div("time", slider, clock),
		choice("Speed", [0.05, 0.1, 0.25, 0.5, 1], (v) => `${v}×`, speed, (v) => { speed = v; }),
		choice("Deflection", [...new Set([1, 2, 5, 10, factor])], (v) => (v > 1 ? `×${v}` : "to scale"), factor,
			(v) => { factor = v; fit(); }));
	const what = isArm ? "arm" : "link", isRigidKnown = links.every((link) => link.rigid_angle_rad);
	const looks = {
		link: `flexible ${what}`, ...(isRigidKnown && { rigid: `rigid ${what}` }), trail: "path of the tip",
		...(wanted && { "line s6 dashed": "wanted path" }), tangent: isArm ? "chords" : slides ? "undeformed link" : "tangent at the hub",
		"arc plus": slides ? "force, to the left" : "torque, counter-clockwise",
		"arc minus": slides ? "force, to the right" : "torque, clockwise",
	};
	stage.after(div("key", ...Object.entries(looks).map((entry) => keyEntry(...entry))));

	// -- View: k pixels a metre, the first joint at ox, oy; y is upward

	const add = (tag, className, attributes) => stage.appendChild(svg(tag, className, attributes));
	const [ground, aim, tangent, rigid] = ["ground", "line s6 dashed", "tangent", "rigid"].map((className) => add("path", className));
	const trail = Array.from({ length: 20 }, () => add("path", "trail"));
	const heaviest = Math.max(...links.flatMap(({ payload, masses }) => [payload.mass_kg, ...masses.map((mass) => mass.mass_kg)]));
	const dot = (className, kg) => add("circle", className, { r: 4 + 4 * Math.sqrt(kg / heaviest || 0) });
	const parts = links.map(({ nodes_m: nodes, thickness, masses, payload }) => ({
		pieces: nodes.slice(1).map((to, e) => { // one an element, as a path has one width
			const x = (to + nodes[e]) / 2, i = Math.max(0, thickness.findLastIndex(([at]) => at <= x));
			const [x0, r0] = thickness[i], [x1, r1] = thickness[i + 1] || [Infinity, r0];
			return add("path", "link", { "stroke-width": 2 + 7 * mix(r0, r1, (x - x0) / (x1 - x0)) });
		}),
		lumps: masses.map((mass) => ({ x: mass.at_m, i: nearest(nodes, mass.at_m), node: dot("mass", mass.mass_kg) })),
		load: payload.mass_kg > 0 && dot("payload", payload.mass_kg),
	}));
	const hubs = links.map(() => ({ hub: add("circle", "hub"), arc: add("path", ""), head: add("path", "") }));

	let k = 1, ox = 0, oy = 0, way = [];
	const hubRadius = (link) => Math.max(isArm ? 5 : 8, link.hub_radius_m * k);
	const toStage = ([x, y]) => [ox + k * x, oy - k * y];
	// A point of a link that lies with its joint at x, y in the direction of an angle, in m.
	const pointOf = ({ x, y, angle, stretch }, along, w) => [
		x + stretch * along * Math.cos(angle) - w * Math.sin(angle), y + stretch * along * Math.sin(angle) + w * Math.cos(angle),
	];
	const place = (pose, along, w) => toStage(pointOf(pose, along, w));
	const path = (points) => `M${points.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join("L")}`;
	const between = (list, at) => {
		const i = clamp(Math.floor(at), 0, count - 2);
		return mix(list[i], list[i + 1], at - i);
	};
	// Where the links are; bent, a chord is shorter than its link.
	const posesOf = (at, angles, chords) => {
		let [x, y] = base ? [0, 1].map((c) => between(base.map((b) => b[c]), at)) : [0, 0];
		return links.map((link) => {
			const stretch = link[chords] ? between(link[chords], at) / link.length_m : 1;
			const angle = between(link[angles], at);
			const pose = slides ? { x: -angle, y, angle: Math.PI / 2, stretch } : { x, y, angle, stretch };
			[x, y] = pointOf(pose, link.length_m, 0);
			return pose;
		});
	};
	const bentPoses = (at) => posesOf(at, "angle_rad", "chord_m"), rigidPoses = (at) => posesOf(at, "rigid_angle_rad");
	const straight = (poses) => [...poses.map((pose) => place(pose, 0, 0)), place(poses.at(-1), links.at(-1).length_m, 0)];

	// Fits the whole motion, with the deflection as large as it is drawn, into the room there is.
	const fit = () => {
		const wide = Math.max(260, stage.clientWidth);
		let right = links[0].hub_radius_m, left = -right, up = left, down = right;
		const include = ([across, below]) => {
			[left, right] = [Math.min(left, across), Math.max(right, across)];
			[up, down] = [Math.min(up, below), Math.max(down, below)];
		};
		[k, ox, oy] = [1, 0, 0];
		times.forEach((_, i) => {
			bentPoses(i).forEach((pose, l) => {
				const { nodes_m: nodes, deflection_m: deflection, length_m: tip, payload } = links[l];
				nodes.forEach((x, j) => include(place(pose, x, factor * deflection[i][j])));
				include(place(pose, tip + (payload.offset_m || 0), factor * deflection[i].at(-1)));
			});
			if (isRigidKnown) straight(rigidPoses(i)).forEach(include);
		});
		for (const at of wanted || []) include(toStage(at));
		const all = links.flatMap((link) => [...link.angle_rad, ...(link.rigid_angle_rad || [])]);
		if (!isArm && !slides && Math.max(...all) - Math.min(...all) > 2 * Math.PI) {
			right = down = Math.max(-left, right, -up, down);
			left = up = -right;
		}
		const margin = 48; // pixels for the torque's arc, the ground and the dots
		k = Math.min((wide - 2 * margin) / (right - left), (440 - 2 * margin) / (down - up));
		const high = Math.max(240, 2 * margin + k * (down - up));
		set(stage, { viewBox: `0 0 ${wide} ${high}` });
		ox = (wide - k * (left + right)) / 2;
		oy = (high - k * (up + down)) / 2;
		way = times.map((_, i) => place(bentPoses(i).at(-1), links.at(-1).length_m, factor * links.at(-1).deflection_m[i].at(-1)));
		if (wanted) set(aim, { d: path(wanted.map(toStage)) });
		const back = ox - hubRadius(links[0]) - 12;
		if (base) set(ground, { d: path(base.map(toStage)) }); // the rail
		else if (slides) set(ground, { d: `M${margin / 2},${oy + 14}H${wide - margin / 2}` });
		else set(ground, { d: `M${ox},${oy}H${back}m0,-18v36${[-18, -9, 0, 9].map((y) => `M${back},${oy + y}l-8,9`).join("")}` });
		hubs.forEach(({ hub }, l) => set(hub, { r: hubRadius(links[l]) }));
		show();
	};

	// -- One moment

	const drawTrail = (at) => {
		// It fades over a quarter of the time; with reduced motion it is all the way so far, and even.
		const still = reduced.matches, from = still ? 0 : at - count / 4;
		trail.forEach((piece, i) => {
			const [a, b] = [i, i + 1].map((n) => Math.max(0, Math.round(mix(from, at, n / trail.length))));
			const opacity = still ? 0.6 : ((i + 1) / trail.length) ** 1.5;
			set(piece, { d: b > a ? path(way.slice(a, b + 1)) : "", opacity });
		});
	};

	const drawHub = ({ hub, arc, head }, link, pose, torque) => {
		const [cx, cy] = place(pose, 0, 0), angle = pose.angle;
		set(hub, { cx, cy });
		const share = clamp(torque / link.peak_torque_n_m || 0, -1.2, 1.2), turn = share * ((2 * Math.PI) / 3); // 120° at the peak
		if (slides) { // an arrow beside the carriage; a positive force points to the left
			const tip = cx - 80 * share, edge = tip + 9 * Math.sign(share), sign = share < 0 ? "minus" : "plus";
			set(arc, { class: `arc ${sign}`, d: `M${cx},${cy + 26}H${edge}` });
			set(head, { class: `arc-head ${sign}`, d: share ? `M${tip},${cy + 26}L${edge},${cy + 20}V${cy + 32}Z` : "" });
			return;
		}
		const radius = Math.max(isArm ? 22 : 30, hubRadius(link) + 10), size = Math.min(11, Math.abs(turn) * radius);
		const at = (a, r = radius) => [cx + r * Math.cos(a), cy - r * Math.sin(a)];
		const end = angle + turn, neck = end - (Math.sign(turn) * size) / radius; // the head is from neck to end
		const sign = turn < 0 ? "minus" : "plus";
		set(arc, { class: `arc ${sign}`, d: `M${at(angle)}A${radius} ${radius} 0 0 ${turn > 0 ? 0 : 1} ${at(neck)}` });
		set(head, { class: `arc-head ${sign}`, d: `${path([at(end), at(neck, radius + size / 2), at(neck, radius - size / 2)])}Z` });
	};

	// Cubics through the nodes, the first tangent to the hub: smooth however few the elements are.
	const drawLink = ({ pieces, lumps, load }, { nodes_m: nodes, payload, chord_m: chord }, w, pose) => {
		const rise = (i, j) => (w[j] - w[i]) / (nodes[j] - nodes[i]), last = w.length - 1;
		const slope = (i) => {
			if (i === 0) return chord && last > 1 ? 1.5 * rise(0, 1) - 0.5 * rise(0, 2) : 0;
			return rise(i - 1, Math.min(last, i + 1));
		};
		const by = (i, dx) => place(pose, nodes[i] + dx, factor * (w[i] + slope(i) * dx));
		pieces.forEach((piece, i) => {
			const third = (nodes[i + 1] - nodes[i]) / 3;
			set(piece, { d: `M${by(i, 0)}C${by(i, third)} ${by(i + 1, -third)} ${by(i + 1, 0)}` });
		});
		const put = (node, [cx, cy]) => set(node, { cx, cy });
		for (const { x, i, node } of lumps) put(node, by(i, x - nodes[i]));
		if (load) put(load, by(last, payload.offset_m || 0));
	};

	let time = start;
	const show = () => {
		const at = ((time - start) / (end - start)) * (count - 1), i = clamp(Math.floor(at), 0, count - 2);
		const poses = bentPoses(at), torques = links.map((link) => between(link.torque_n_m, at));
		set(tangent, { d: path(straight(poses)) });
		if (isRigidKnown) set(rigid, { d: path(straight(rigidPoses(at))) });
		poses.forEach((pose, l) => {
			const { deflection_m: deflection } = links[l];
			drawLink(parts[l], links[l], deflection[i].map((w, j) => mix(w, deflection[i + 1][j], at - i)), pose);
			drawHub(hubs[l], links[l], pose, torques[l]);
		});
		drawTrail(at);

		slider.value = time;
		clock.textContent = `${number(time, (end - start) / 2000)} s`;
		set(slider, { "aria-valuetext": clock.textContent });
		const [torque] = torques, [{ x, angle }] = poses, peak = links[0].peak_torque_n_m;
		const sense = Math.abs(torque) < peak / 1000 ? "" : torque > 0 ? " counter-clockwise" : " clockwise";
		const amounts = torques.map((one, l) => number(one, links[l].peak_torque_n_m / 1000 || 1)).join(", ");
		caption.textContent = `Seen from ${motion.seen_from}, deflection ${factor > 1 ? `${factor} times as large` : "to scale"}. `
			+ (isArm ? `At ${clock.textContent}: torques ${amounts} N m, from the inner joint outward.`
				: slides ? `At ${clock.textContent}: force ${amounts} N, carriage at ${number(-x, 1e-4)} m.`
				: `At ${clock.textContent}: torque ${amounts} N m${sense}, `
					+ `hub angle ${number(angle, 1e-4)} rad (${number((angle * 180) / Math.PI, 0.01)}°).`);
		timeGroup.now = time;
		for (const chart of timeGroup.charts) chart.drawNow();
	};

	// -- Playing

	let playing = false, last = 0, request = 0;
	const step = (now) => {
		const passed = (now - last) / 1000;
		if (playing && passed > (reduced.matches ? 0.1 : 0)) { // with reduced motion ten pictures a second
			last = now;
			time = Math.min(end, time + passed * speed);
			show();
			if (time === end) setPlaying(false);
		}
		if (playing) request = requestAnimationFrame(step);
	};
	const setPlaying = (on) => {
		if (on && time === end) time = start;
		playing = on;
		play.textContent = on ? "Pause" : "Play";
		last = performance.now();
		cancelAnimationFrame(request);
		if (on) request = requestAnimationFrame(step);
	};
	// It starts when first seen, unless it was touched before or motion is not wanted.
	const seen = new IntersectionObserver(([entry]) => {
		if (!entry.isIntersecting) return;
		seen.disconnect();
		if (!reduced.matches) setPlaying(true);
	}, { threshold: 0.5 });
	seen.observe(stage);
	const touch = (on) => {
		seen.disconnect();
		setPlaying(on);
	};
	seek = (t) => {
		touch(false);
		time = clamp(t, start, end);
		show();
	};
	setPlaying(false);
	play.onclick = () => touch(!playing);
	slider.oninput = () => seek(+slider.value);
	set(stage, { tabindex: 0 }).onkeydown = (event) => {
		if (event.key !== " ") return;
		event.preventDefault();
		touch(!playing);
	};
	addEventListener("resize", fit);
	fit();
}
if (motion) animate(...["#stage", "#animation .controls", "#stage-caption"].map((name) => document.querySelector(name)));
