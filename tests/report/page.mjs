// npm install && node page.mjs CHROMIUM PAGE.html [--points FILE.json] [PAGE.html …]: opens pages of `flexlink report` and tries all that they must do.
//
// --points belongs to the page before it: [{"figure": "fig-torque", "line": "flexible link",
// "x": 0.187, "y": 1.358, "within": 0.002}, …], values that the line of the figure must show there.
// Exit code 0: every check passed, 1: one did not, 2: wrong usage.

import { readFile, stat } from "node:fs/promises";
import { basename, dirname, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import axe from "axe-core";
import puppeteer from "puppeteer-core";

const MOST_BYTES = 2e6;
const SLOW_MS = 1000; // what a page should take to open
const MOST_MS = 3000; // what fails: machines differ
const wide = { width: 1280, height: 900 };
const narrow = { width: 390, height: 740, isMobile: true, hasTouch: true, deviceScaleFactor: 2 };

const [chromium, ...rest] = process.argv.slice(2);
const pages = [];
for (let i = 0; i < rest.length; i++) {
  if (rest[i] !== "--points") pages.push({ file: resolve(rest[i]), points: null });
  else if (pages.length && rest[i + 1]) pages.at(-1).points = rest[++i];
  else usage();
}
if (!chromium || !pages.length) usage();

function usage() {
  console.error("usage: node page.mjs CHROMIUM PAGE.html [--points FILE.json] [PAGE.html …]");
  process.exit(2);
}

const must = (holds, message) => { if (!holds) throw new Error(message); };
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
let passed = 0, failed = 0, where = "";

async function check(name, body) {
  try {
    const note = await body();
    passed++;
    console.log(`ok    ${where}: ${name}${note ? `: ${note}` : ""}`);
  } catch (error) {
    failed++;
    console.log(`FAIL  ${where}: ${name}: ${error.message}`);
  }
}

// A tab of its own storage, that keeps what was asked of the network and said on the console.
async function open(browser, file, viewport, features = {}) {
  const context = await browser.createBrowserContext();
  const page = await context.newPage();
  const url = pathToFileURL(file).href;
  const asked = [], said = [];
  page.on("console", (message) => {
    if (["error", "warn", "assert"].includes(message.type())) said.push(`${message.type()}: ${message.text()}`);
  });
  page.on("pageerror", (error) => said.push(`error: ${error.message}`));
  await page.setRequestInterception(true);
  page.on("request", (request) => {
    const own = request.url().split("#")[0] === url || /^(data|blob):/.test(request.url());
    if (!own) asked.push(request.url());
    // Another file is answered, to be told of here rather than as an error on the console.
    if (own || request.url().startsWith("file:")) request.continue();
    else request.abort();
  });
  const wanted = { "prefers-color-scheme": "light", "prefers-reduced-motion": "no-preference", ...features };
  await page.emulateMediaFeatures(Object.entries(wanted).map(([name, value]) => ({ name, value })));
  await page.setViewport(viewport);
  await page.evaluateOnNewDocument(() => {
    addEventListener("securitypolicyviolation", (event) => console.error(`the policy refuses ${event.violatedDirective} ${event.blockedURI}`));
    // Files that the page gives its reader are kept instead.
    window.given = [];
    const blobs = new Map(), create = URL.createObjectURL.bind(URL);
    URL.createObjectURL = (blob) => {
      const address = create(blob);
      blobs.set(address, blob);
      return address;
    };
    HTMLAnchorElement.prototype.click = function () { window.given.push({ name: this.download, blob: blobs.get(this.href) }); };
    addEventListener("DOMContentLoaded", () => requestAnimationFrame(() => setTimeout(() => { window.openedAfter = performance.now(); })));
  });
  await page.goto(url, { waitUntil: "load", timeout: 60_000 });
  await page.waitForFunction("window.openedAfter", { timeout: 60_000 });
  return { page, asked, said, close: () => context.close() };
}

const figuresOf = (page) => page.$$eval("figure.chart", (all) => all.map((figure) => figure.id));
const ticksOf = (page, id) => page.$eval(`#${id}`, (figure) => [...figure.querySelectorAll(".ticks.x text")].map((t) => t.textContent).join(" "));
const readOut = (page, id) => page.$eval(`#${id}`, (figure) => [...figure.querySelectorAll(".key .value")].map((v) => v.textContent));
const full = (values) => values.length > 1 && values[0] !== "" && values.slice(1).some((text) => /\d/.test(text));
const boxOf = async (page, id) => {
  const reader = await page.$(`#${id} .reader`);
  must(reader, `${id} has nothing to read it with: did the script run?`);
  await reader.evaluate((node) => node.scrollIntoView({ block: "center" }));
  return reader.boundingBox();
};
const timeCharts = (page) =>
  page.$$eval("figure.chart", (all) => all.filter((f) => f.querySelector("[data-x-axis=time]")).map((f) => f.id));
const sliderValue = (page) => page.$eval("#animation input[type=range]", (slider) => Number(slider.value));
const playButton = async (page) => {
  for (const button of await page.$$("#animation .controls button"))
    if (/play|pause/i.test(await button.evaluate((node) => node.textContent))) return button;
  throw new Error("the animation has no button to play it");
};
const background = (page) => page.evaluate(() => getComputedStyle(document.body).backgroundColor);

// What a page tells first, and what last.
const RANKS = { warnings: 0, undetermined: 1, first: 2, animation: 3, arm: 4, figures: 5, remarks: 6, link: 7, glossary: 8, inputs: 10 };

async function order(page, name) {
  await check("warnings come first, then torque, tip and hub, then the rest, tables last", async () => {
    const ids = await page.$$eval("main > section", (all) => all.map((section) => section.id));
    const ranks = ids.map((id) => RANKS[id] ?? 9);
    must(ranks.every((rank, i) => !i || ranks[i - 1] <= rank), ids.join(", "));
    const linked = await page.$$eval(".contents a", (all) => all.map((a) => a.getAttribute("href").slice(1)));
    must(linked.join() === ids.join(), `the contents have ${linked.join(", ")}`);
    const early = await page.$$eval("main section:is(#warnings, #undetermined, #first, #animation, #figures) .scroll table", (all) => all.filter((table) => !table.closest("details")).length);
    must(!early, `${early} tables stand before the end`);
    const first = await page.$$eval("#first figure", (all) => all.map((figure) => figure.id));
    must(!first.length || (first[0].startsWith("fig-torque") && first.every((id) => /^fig-(torque|tip|hub|motor|angle|rate|power)/.test(id))), first.join(", "));
    return ids.join(", ");
  });
  await check("the paper is named for its own link and motion alone", async () => {
    const captions = await page.$$eval("figcaption", (all) => all.map((caption) => caption.textContent).join(" "));
    must(!/of the paper|\(figures? \d/.test(captions), captions);
    const named = captions.match(/Bayo 1987, figure \d/g) || [];
    must(["paper/report.html", "beside.html"].includes(name) === (named.length === 5), `${named.length} figures: ${named.join(", ")}`);
    return named.join(", ");
  });
  await check("every figure has its formula in a fold, and the glossary its words", async () => {
    const folds = await page.$$eval("figure.chart", (all) => all.map((figure) => [figure.id, figure.querySelector("details.formula p")?.textContent || "", figure.querySelector("details.formula")?.open]));
    for (const [id, text, open] of folds) must(text.length > 8 && open === false, `${id}: ${open} ${text}`);
    const maps = await page.$$eval("figure.chart:has(svg[data-x-axis=time] image)", (all) => all.map((figure) => [figure.id, figure.querySelector(".legend").textContent, figure.querySelector("details.formula p").textContent]));
    for (const [id, legend, text] of maps) must(text.startsWith(legend.includes("deflection in m") ? "w(x, t)" : "m(x, t)"), `${id}: ${legend}, but ${text}`);
    const words = await page.$$eval("#glossary details dt", (all) => all.map((word) => word.textContent));
    const expected = /robust|uncertain/.test(name) ? "tip error,rest vibration,drift,settling" : "zero,lead,lag,hysteretic";
    must(words.join() === expected, words.join());
  });
}

// A policy that lets no other script and no style run; broken on purpose, so after all else.
async function policy(page) {
  await check("the content security policy is strict, and holds", async () => {
    const text = await page.$eval("meta[http-equiv='Content-Security-Policy']", (meta) => meta.content);
    must(/default-src 'none'/.test(text) && !/unsafe|\*|http/.test(text), text);
    const found = await page.evaluate(() => {
      const script = document.createElement("script"), box = document.createElement("p");
      script.textContent = "window.injected = true";
      box.setAttribute("style", "color: rgb(1, 2, 3)");
      document.body.append(script, box);
      return { ran: window.injected, colour: getComputedStyle(box).color };
    });
    must(!found.ran && found.colour !== "rgb(1, 2, 3)", JSON.stringify(found));
    const inline = await page.$$eval("[onclick], [onload], script[src], link, iframe", (all) => all.length);
    must(!inline, `${inline} elements that a strict policy refuses`);
  });
}

const numberIn = (text) => Number(text.replaceAll("−", "-"));
// Fields of a line of CSV.
const fieldsOf = (line) => [...line.matchAll(/("(?:[^"]|"")*"|[^,]*)(?:,|$)/g)].slice(0, -1).map(([, field]) => field.replace(/^"|"$/g, "").replaceAll('""', '"'));

async function files(page) {
  await check("the CSV file of each figure holds the numbers of its table", async () => {
    let rows = 0;
    for (const id of await figuresOf(page)) {
      const { text, table, name } = await page.$eval(`#${id}`, async (figure) => {
        window.given.length = 0;
        [...figure.querySelectorAll(".files button")].find((button) => button.textContent === "CSV").click();
        const [{ name, blob }] = window.given;
        const table = [...figure.querySelectorAll(".numbers tr")].map((row) => [...row.cells].map((cell) => cell.textContent));
        return { name, text: await blob.text(), table };
      });
      must(name === `${id.replace("fig-", "")}.csv`, `${id}: ${name}`);
      const [head, ...lines] = text.trim().split("\n").map(fieldsOf);
      must(lines.length > 1 && lines.every((line) => line.length === head.length), `${id}: ${lines.length} rows, ${head}`);
      rows += lines.length;
      must(!/NaN|undefined|Infinity|−/.test(text), `${id}: no numbers`);
      const digits = Math.max(...lines.flat().map((field) => field.replace(/e.*$/, "").replace(/[-.]/g, "").replace(/^0+/, "").length));
      must(digits >= 6, `${id}: numbers of at most ${digits} digits`);
      const isMapOverTime = await page.$eval(`#${id}`, (figure) => !!figure.querySelector("svg[data-x-axis=time] image"));
      if (isMapOverTime) {
        must(head.slice(1).every((column) => /^(moment|deflection) at x = [\d.e-]+ m in (N m|m)$/.test(column)), `${id}: ${head}`);
        continue;
      }
      must(head.join("|") === table[0].join("|"), `${id}: ${head.join("|")}, the table ${table[0].join("|")}`);
      const values = lines.map((line) => line.map((field) => (field === "" ? NaN : +field)));
      // Lines have the digits of their common axis.
      const axes = await page.$eval(`#${id} svg.chart`, ({ dataset: { x, y } }) => [x, y].map((ends) => Math.max(...ends.split(" ").map((end) => Math.abs(end)))));
      const peaks = head.map((_, column) => axes[Math.min(column, 1)]);
      for (const row of table.slice(1).map((cells) => cells.map((cell) => (cell === "" ? NaN : numberIn(cell))))) {
        const near = (a, b, column) => Math.abs(a - b) <= 6e-4 * Math.abs(a) + 3e-6 * peaks[column] || (a !== a && b !== b);
        must(values.some((own) => row.every((value, column) => near(value, own[column], column))), `${id}: no row ${row.join(", ")}`);
      }
    }
    return `${rows} rows`;
  });
  await check("the PNG file of each figure is its picture", async () => {
    for (const id of await figuresOf(page)) {
      const found = await page.$eval(`#${id}`, async (figure) => {
        window.given.length = 0;
        [...figure.querySelectorAll(".files button")].find((button) => button.textContent === "PNG").click();
        for (let tries = 0; tries < 100 && !window.given.length; tries++) await new Promise((done) => setTimeout(done, 20));
        const [{ name, blob }] = window.given, picture = await createImageBitmap(blob);
        const canvas = new OffscreenCanvas(picture.width, picture.height), context = canvas.getContext("2d");
        context.drawImage(picture, 0, 0);
        const { data } = context.getImageData(0, 0, picture.width, picture.height), colours = new Set();
        for (let i = 0; i < data.length; i += 4) colours.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
        return { name, type: blob.type, width: picture.width, colours: colours.size, corner: [...data.slice(0, 4)].join() };
      });
      must(found.name.endsWith(".png") && found.type === "image/png" && found.width === 1520, `${id}: ${JSON.stringify(found)}`);
      must(found.colours > 20 && found.corner === "255,255,255,255", `${id}: ${JSON.stringify(found)}`);
    }
  });
}

async function dark(browser, page) {
  await check("no white panel in dark mode", async () => {
    const counter = await browser.newPage();
    const shares = [];
    for (const figure of await page.$$("figure")) {
      const id = await figure.evaluate((node) => node.id || node.className);
      const picture = await figure.screenshot({ encoding: "base64" });
      const share = await counter.evaluate(async (picture) => {
        const image = new Image();
        image.src = `data:image/png;base64,${picture}`;
        await image.decode();
        const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
        context.drawImage(image, 0, 0);
        const { data } = context.getImageData(0, 0, image.width, image.height);
        let bright = 0;
        for (let i = 0; i < data.length; i += 4) bright += Math.min(data[i], data[i + 1], data[i + 2]) > 200;
        return (4 * bright) / data.length;
      }, picture);
      shares.push([share, id]);
      must(share < 0.06, `${id}: ${Math.round(share * 100)} % of it are nearly white`);
    }
    await counter.close();
    const [share, id] = shares.sort(([a], [b]) => b - a)[0];
    return `at most ${(share * 100).toFixed(1)} %, ${id}`;
  });
}

async function particulars(page, name) {
  const seen = (selector) => page.$$eval(selector, (all) => all.filter((node) => node.checkVisibility({ visibilityProperty: true })).map((node) => node.textContent));
  if (name === "paper/report.html") await check("limits are lines in the figures, and the waves have a scale in N m", async () => {
    const limits = await page.$$eval(".zoom .limit", (all) => all.map((line) => `${line.closest("figure").id} ${line.dataset.name}`));
    must(limits.join() === "fig-torque limit 2 N m,fig-hub-rate limit 0.5 rad/s,fig-tip-deflection limit 0.1 m", limits.join());
    must((await seen("#fig-torque .key")).join().includes("limit 2 N m"), "the key does not name the limit");
    const scale = await seen("#fig-waves .legend text");
    must(scale.some((text) => text === "moment in N m") && scale.filter((text) => /^−?[\d.]+$/.test(text)).length === 3, scale.join(" | "));
    must(/hub_rate/.test((await seen("#warnings")).join()), "the exceeded limit is no warning");
    for (const text of ["1.900", "damping ratio", "hysteretic, ratio 0.02", "the tip's travel", "the peak of the torque"])
      must((await seen("#results")).join().includes(text), `the tables lack ${text}`);
  });
  if (name === "dots.html") await check("the CSV file of dots has a row for each case", async () => {
    const { csv, cases } = await page.evaluate(async () => {
      window.given.length = 0;
      [...document.querySelectorAll("#fig-peak-torque .files button")].find((button) => button.textContent === "CSV").click();
      const [head, ...rows] = [...document.querySelectorAll("#cases tr")].map((row) => [...row.cells].map((cell) => cell.textContent));
      const places = ["hub.inertia", "peak_torque_n_m"].map((name) => head.indexOf(name));
      return { csv: await window.given[0].blob.text(), cases: rows.map((row) => places.map((place) => +row[place])) };
    });
    const rows = csv.trim().split("\n").slice(1).map(fieldsOf);
    must(rows.length === 72 && cases.length === 72, `${rows.length} rows of ${cases.length} cases`);
    for (const [x, torque] of cases) {
      const at = rows.findIndex((row) => Math.abs(row[0] - x) < 1e-6 && Math.abs(row[1] - torque) < 1e-4 * torque);
      must(at >= 0, `no row of ${x}, ${torque}`);
      const [[, , kind]] = rows.splice(at, 1);
      must(kind === (torque > 1.5 ? "over the limit 1.5 N m" : "within the limit"), `${torque} N m: ${kind}`);
    }
  });
  if (name.endsWith("report.html")) await check("captions have the numbers of the tables", async () => {
    const rows = await page.$$eval("#results .readings tr, #results .scroll tr", (all) => all.map((row) => row.textContent));
    for (const [figure, words] of [["fig-torque", "peak torque"], ["fig-torque-1", "peak torque"], ["fig-tip-acceleration", "peak tip acceleration"], ["fig-tip-deflection", "peak deflection"]]) {
      if (!(await page.$(`#${figure}`))) continue;
      const [peak] = (await page.$eval(`#${figure} figcaption`, (caption) => caption.textContent)).match(/(?<=at most )[\d.]+ [^.;, (]+/i);
      const row = rows.find((text) => text.startsWith(words));
      must(!row || row.includes(peak), `${figure} tells ${peak}, the table ${row}`);
    }
  });
  if (name === "arms.html") await check("limits of joints and links are lines in the figures, and the motor has its own", async () => {
    const limits = await page.$$eval(".zoom .limit", (all) => all.map((line) => `${line.closest("figure").id} ${line.dataset.name}`));
    must(limits.join() === "fig-rate-2 limit 3 rad/s,fig-tip-deflection-2 limit 0.05 m,fig-root-moments link 2: limit 5 N m", limits.join());
    must((await page.$$("#fig-motor-torque-2 .zoom .line")).length === 2, "the motor has no line of each run");
  });
  if (name === "played/report.html") await check("a simulation shows its target, its error and the limits of the link", async () => {
    const lines = await page.$$eval("#first .zoom :is(.line, .limit)", (all) => all.map((line) => `${line.closest("figure").id} ${line.dataset.name}`));
    for (const line of ["fig-tip-displacement wanted", "fig-tip-error simulated less wanted", "fig-torque limit 1.2 N m", "fig-tip-deflection limit 0.2 m"])
      must(lines.includes(line), `${line} is not among ${lines.join(", ")}`);
  });
  if (name === "beside.html") await check("two runs have their lines in one figure, and their numbers in one table", async () => {
    for (const id of ["fig-torque", "fig-tip-displacement", "fig-hub-angle"]) {
      const lines = await page.$$eval(`#${id} .zoom .line`, (all) => all.map((line) => line.dataset.name));
      for (const run of ["paper", "played"]) must(lines.includes(run), `${id}: ${lines}`);
    }
    const head = await page.$$eval("#beside table:first-of-type thead th", (all) => all.map((cell) => cell.textContent));
    must(head.join().startsWith("quantity,paper,played"), head.join());
    must((await seen("#figures")).join().includes("since these figures hold one"), "it hides what stands alone");
  });
  if (name === "fit.html") await check("measured dots are seen beside the line of the fitted link", async () => {
    const widths = await page.$$eval("#fig-overlay-1 .zoom :is(.dots, .thin)", (all) => all.map((line) => [line.classList[0], parseFloat(getComputedStyle(line).strokeWidth)]));
    must(widths.length === 2 && widths[0][0] === "dots" && widths[0][1] > 3 * widths[1][1], JSON.stringify(widths));
  });
  if (name === "line.html") await check("the axis of equal factors is logarithmic", async () => {
    const scales = await page.$$eval("svg.chart", (all) => all.map((chart) => chart.dataset.xScale));
    must(scales.every((scale) => scale === "log"), scales.join());
  });
  if (name === "sweep.html") await check("a map of fields has their numbers, and the page tells link, inputs and warnings", async () => {
    for (const id of await figuresOf(page)) must((await seen(`#${id} .fields text`)).length === 15, `${id}: ${await seen(`#${id} .fields text`)}`);
    for (const [section, text] of [["warnings", "inexact model"], ["link", "hysteretic, ratio 0.02"], ["varied", "payload.mass in kg"], ["inputs", "bayo1987_example1.toml"]])
      must((await seen(`#${section}`)).join().includes(text), `${section} lacks ${text}`);
    must((await seen("h1")).join().includes("Bayo (1987), example 1"), "the heading lacks the link");
    for (const [id, limit] of [["fig-peak-torque", 1.8], ["fig-peak-deflection", 0.2], ["fig-feasible", 1]]) {
      const over = (await page.$$eval(`#${id} .fields text`, (all) => all.map((text) => +text.textContent))).filter((value) => value > limit).length;
      const hatched = await page.$$eval(`#${id} .hatch .stripes[data-row]`, (all) => all.filter((path) => getComputedStyle(path).stroke !== "none").length);
      must(over > 0 && over < 15 && hatched === over, `${id}: ${hatched} hatched, ${over} over ${limit}`);
    }
    must((await page.$$("#link svg .segment")).length === 2, "the link is not drawn");
  });
}

async function quiet({ asked, said }) {
  await check("asks nothing of the network or of other files", async () => must(!asked.length, asked.join(", ")));
  await check("no error or warning on the console", async () => must(!said.length, said.join(" | ")));
}

async function accessible(page) {
  for (const scheme of ["light", "dark"]) {
    await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: scheme }, { name: "prefers-reduced-motion", value: "reduce" }]);
    await check(`axe-core finds nothing serious, ${scheme}`, async () => {
      await page.evaluate(() => { for (const more of document.querySelectorAll("details")) more.open = true; });
      if (!(await page.evaluate("typeof axe === 'object'"))) await page.evaluate(axe.source);
      const { violations, passes } = await page.evaluate(() => globalThis.axe.run(document, {
        runOnly: { type: "tag", values: ["wcag2a", "wcag2aa", "wcag21aa", "best-practice"] },
      }));
      must(passes.length > 5, "axe-core looked at nearly nothing");
      const grave = violations.filter(({ impact }) => ["serious", "critical"].includes(impact));
      must(!grave.length, grave.map(({ id, help, nodes }) => `${id} (${help}) at ${nodes[0].target}, ${nodes.length} in all`).join("; "));
      return `${passes.length} rules hold${violations.length ? `, lesser: ${violations.map(({ id }) => id).join(", ")}` : ""}`;
    });
  }
}

async function figures(page) {
  await check("every figure holds a line or an image", async () => {
    const held = await page.$$eval("figure.chart", (all) => all.map((figure) => ({
      id: figure.id,
      points: [...figure.querySelectorAll("svg.plot .zoom path:is(.line, .dots)")].reduce((n, p) => n + (p.getAttribute("d").match(/[ML]/g) || []).length, 0),
      image: [...figure.querySelectorAll("svg.plot .zoom image")].some((i) => (i.getAttribute("href") || "").length > 100),
    })));
    must(held.length, "the page has no figure");
    for (const { id, points, image } of held) must(points > 1 || image, `${id} holds neither`);
    return `${held.length} figures`;
  });

  await check("the pointer reads every figure", async () => {
    for (const id of await figuresOf(page)) {
      const box = await boxOf(page, id);
      const seen = [];
      for (const part of [0.3, 0.7]) {
        await page.mouse.move(box.x + box.width * part, box.y + box.height / 2);
        const values = await readOut(page, id);
        must(full(values), `${id}: the read-out is empty: ${JSON.stringify(values)}`);
        seen.push(values[0]);
      }
      must(seen[0] !== seen[1], `${id}: the read-out stays at ${seen[0]}`);
    }
    await page.mouse.move(1, 1);
  });

  await check("the keyboard reads every figure", async () => {
    for (const id of await figuresOf(page)) {
      await boxOf(page, id);
      await page.focus(`#${id} .reader`);
      await page.keyboard.press("Home");
      const first = (await readOut(page, id))[0];
      for (const key of ["ArrowRight", "ArrowRight"]) await page.keyboard.press(key);
      await page.keyboard.down("Shift");
      await page.keyboard.press("ArrowRight");
      await page.keyboard.up("Shift");
      const values = await readOut(page, id);
      must(full(values), `${id}: the read-out is empty: ${JSON.stringify(values)}`);
      must(values[0] !== first, `${id}: the arrows do not move the cursor from ${first}`);
      const said = await page.$eval(`#${id} .reader`, (node) => node.getAttribute("aria-valuetext"));
      must(said.includes(values[0]), `${id}: what is read aloud lacks ${values[0]}: ${said}`);
    }
  });

  await check("zoom is shared by the figures over time, and by no other", async () => {
    const ids = await figuresOf(page), overTime = await timeCharts(page);
    const all = async () => Object.fromEntries(await Promise.all(ids.map(async (id) => [id, await ticksOf(page, id)])));
    const resets = () => page.$$eval(".tools button:last-child", (buttons) => buttons.filter((b) => b.offsetParent).length);
    const before = await all();
    for (const id of [overTime[0], ...ids.filter((one) => !overTime.includes(one))].filter(Boolean)) {
      const together = overTime.includes(id) ? overTime : [id];
      const box = await boxOf(page, id);
      await page.mouse.move(box.x + box.width * 0.35, box.y + 20);
      await page.mouse.down();
      await page.mouse.move(box.x + box.width * 0.6, box.y + 40, { steps: 4 });
      await page.mouse.up();
      const zoomed = await all();
      for (const other of ids) {
        const changed = zoomed[other] !== before[other];
        must(changed === together.includes(other), `a drag in ${id} ${changed ? "changes" : "does not change"} the ticks of ${other}: ${zoomed[other]}`);
      }
      must((await resets()) === together.length, `${await resets()} buttons to reset the zoom are seen, not ${together.length}`);
      await page.mouse.click(box.x + box.width / 2, box.y + 30, { clickCount: 2 });
      must(JSON.stringify(await all()) === JSON.stringify(before), `a double click in ${id} does not undo the zoom`);
      await page.focus(`#${id} .reader`);
      await page.keyboard.press("+");
      must((await all())[id] !== before[id], `the key + does not zoom ${id}`);
      await page.keyboard.press("Escape");
      must(JSON.stringify(await all()) === JSON.stringify(before), `Escape in ${id} does not undo the zoom`);
      must((await resets()) === 0, "a button to reset the zoom stays");
    }
    return overTime.length ? `${overTime.length} over time` : "none over time";
  });
}

// Texts of figures and drawings lie within the page, and none lies on another.
async function texts(page) {
  await check("no text of a figure is cut off or lies on another", async () => {
    const { seen, faults } = await page.evaluate(() => {
      const faults = [], room = document.documentElement.clientWidth;
      let seen = 0;
      for (const drawing of document.querySelectorAll("svg:is(.chart, #stage), .drawing > svg")) {
        const outer = drawing.getBoundingClientRect();
        const boxes = [...drawing.querySelectorAll("text")].filter((text) => text.textContent && text.checkVisibility({ visibilityProperty: true }))
          .map((text) => ({ name: text.textContent, box: text.getBoundingClientRect() })).filter(({ box }) => box.width > 0);
        const figure = drawing.closest("figure").id || "a drawing";
        seen += boxes.length;
        for (const [i, { name, box }] of boxes.entries()) {
          if (box.left < Math.max(0, outer.left) - 1 || box.right > Math.min(room, outer.right) + 1) faults.push(`${figure}: "${name}" is cut off`);
          for (const other of boxes.slice(i + 1)) {
            const across = Math.min(box.right, other.box.right) - Math.max(box.left, other.box.left);
            const down = Math.min(box.bottom, other.box.bottom) - Math.max(box.top, other.box.top);
            // Boxes of letters are higher than the letters.
            if (across > 1 && down > 5) faults.push(`${figure}: "${name}" lies on "${other.name}"`);
          }
        }
      }
      return { seen, faults };
    });
    must(seen > 5, `only ${seen} texts`);
    must(!faults.length, faults.join("; "));
    return `${seen} texts`;
  });
}

// Reads the page's lines by themselves, not through its script.
async function holdsPoints(page, file) {
  const wanted = JSON.parse(await readFile(file, "utf8"));
  await check(`lines pass through the points of ${basename(file)}`, async () => {
    must(wanted.length, "the file holds no point");
    let worst = 0;
    for (const { figure, line, x, y, within } of wanted) {
      const found = await page.evaluate((figure, line, x) => {
        const chart = document.getElementById(figure)?.querySelector("svg.chart");
        if (!chart) return "there is no such figure";
        const path = [...chart.querySelectorAll(".zoom path.line")].find((one) => one.getAttribute("data-name") === line);
        if (!path) return "there is no such line";
        // The line above a map has its own axis.
        const numbers = (name) => (path.getAttribute(name) || chart.getAttribute(name)).trim().split(/\s+/).map(Number);
        const [, , width, height] = numbers("data-plot");
        const [above, band] = (path.dataset.band || chart.dataset.band || `0 ${height}`).split(/\s+/).map(Number);
        const scale = (name, v) => (chart.getAttribute(`${name}-scale`) === "log" ? Math.log10(v) : v);
        const back = (name, s) => (chart.getAttribute(`${name}-scale`) === "log" ? 10 ** s : s);
        const ends = (name) => numbers(name).map((v) => scale(name, v));
        const [x0, x1] = ends("data-x"), [y0, y1] = ends("data-y");
        const u = ((scale("data-x", x) - x0) / (x1 - x0)) * width;
        const points = [...path.getAttribute("d").matchAll(/([ML])(-?[\d.e-]+),(-?[\d.e-]+)/g)].map((m) => [m[1], +m[2], +m[3]]);
        for (let i = 1; i < points.length; i++) {
          const [, ua, va] = points[i - 1], [command, ub, vb] = points[i];
          if (command === "M" || u < Math.min(ua, ub) - 0.01 || u > Math.max(ua, ub) + 0.01) continue;
          const v = ub === ua ? vb : va + ((vb - va) * (u - ua)) / (ub - ua);
          return back("data-y", y0 + (1 - (v - above) / band) * (y1 - y0));
        }
        return "the line does not reach there";
      }, figure, line, x);
      must(typeof found === "number", `${figure}, ${line}, x = ${x}: ${found}`);
      must(Math.abs(found - y) <= within, `${figure}, ${line}, x = ${x}: found ${found}, must be ${y} within ${within}`);
      worst = Math.max(worst, Math.abs(found - y) / within);
    }
    return `${wanted.length} points, the worst at ${Math.round(worst * 100)} % of what is allowed`;
  });
}

async function animation(browser, file) {
  const still = await open(browser, file, wide, { "prefers-reduced-motion": "reduce" });
  await check("with reduced motion the animation does not start by itself", async () => {
    await still.page.$eval("#stage", (stage) => stage.scrollIntoView({ block: "center" }));
    const before = await sliderValue(still.page);
    await wait(700);
    must((await sliderValue(still.page)) === before, `the time went from ${before} to ${await sliderValue(still.page)} s`);
  });
  await check("play moves the time, pause stops it", async () => {
    const { page } = still;
    const button = await playButton(page);
    const at = [await sliderValue(page)];
    await button.click();
    await wait(500);
    at.push(await sliderValue(page));
    must(at[1] > at[0], `after play the time stays at ${at[1]} s`);
    await button.click();
    await wait(150);
    at.push(await sliderValue(page));
    await wait(500);
    at.push(await sliderValue(page));
    must(at[3] === at[2], `after pause the time goes on from ${at[2]} to ${at[3]} s`);
    await page.$eval("#stage", (stage) => stage.focus());
    await page.keyboard.press("Space");
    await wait(500);
    await page.keyboard.press("Space");
    const on = await sliderValue(page);
    must(on > at[3], `the space bar on the stage does not play: the time stays at ${on} s`);
    return `${at[0]} to ${on} s`;
  });
  await check("the caption and the charts follow the time", async () => {
    const { page } = still;
    const state = () => page.evaluate(() => [
      document.getElementById("stage-caption").textContent,
      document.querySelector("#animation input[type=range]").getAttribute("aria-valuetext"),
      [...document.querySelectorAll(".now")].map((line) => line.getAttribute("x1")).join(" "),
    ]);
    const before = await state();
    await page.focus("#animation input[type=range]");
    for (let i = 0; i < 10; i++) await page.keyboard.press("ArrowRight");
    const after = await state();
    ["caption", "text of the slider", "line in the charts"].forEach((what, i) => must(before[i] !== after[i], `the ${what} stays: ${after[i]}`));
    must(after[0].includes(after[1]), `the caption lacks the time ${after[1]}: ${after[0]}`);
  });
  await quiet(still);
  await still.close();

  const moving = await open(browser, file, wide);
  await check("it starts by itself when it is first seen", async () => {
    const { page } = moving;
    const before = await sliderValue(page);
    await page.$eval("#stage", (stage) => stage.scrollIntoView({ block: "center" }));
    await wait(700);
    must((await sliderValue(page)) > before, `the time stays at ${before} s`);
    await (await playButton(page)).click();
  });
  await moving.close();
}

async function themes(page) {
  await check("the theme button changes the background, and is remembered", async () => {
    const button = await page.$("#theme");
    must(button && (await button.isVisible()), "there is no theme button to be seen");
    const seen = {};
    for (let i = 0; i < 3; i++) {
      await button.click();
      seen[await page.evaluate(() => document.documentElement.dataset.theme)] = await background(page);
    }
    must(seen.light && seen.dark, `it does not go through light and dark: ${JSON.stringify(seen)}`);
    must(seen.light !== seen.dark, `the background stays ${seen.light}`);
    while ((await page.evaluate(() => document.documentElement.dataset.theme)) !== "dark") await button.click();
    await page.reload();
    must((await background(page)) === seen.dark, "after opening the page again dark is forgotten");
    return `${seen.light}, ${seen.dark}`;
  });
  await check("paper is white, and holds no buttons", async () => {
    await page.emulateMediaType("print");
    const seen = await page.evaluate(() => ({
      buttons: [...document.querySelectorAll("button, #animation, .reader")].filter((node) => node.checkVisibility()).length,
      open: document.querySelectorAll("details[open]").length,
    }));
    const paper = await background(page);
    await page.emulateMediaType("screen");
    must(paper === "rgb(255, 255, 255)", `the background is ${paper}`);
    must(!seen.buttons, `${seen.buttons} buttons are seen`);
    must(!seen.open, `${seen.open} details are open`);
  });
}

async function tryPage(browser, { file, points }) {
  const name = file.endsWith("report.html") ? `${basename(dirname(file))}/report.html` : basename(file);
  where = name;
  await check("is at most 2 MB", async () => {
    const { size } = await stat(file);
    must(size <= MOST_BYTES, `${size} bytes`);
    return `${(size / 1000).toFixed(0)} kB`;
  });

  for (const viewport of [wide, narrow]) {
    where = `${name} at ${viewport.width}`;
    const tab = await open(browser, file, viewport, viewport === narrow ? { "prefers-reduced-motion": "reduce" } : {});
    const { page } = tab;
    await check("opens in time", async () => {
      const ms = await page.evaluate("window.openedAfter");
      must(ms <= MOST_MS, `${ms.toFixed(0)} ms to the first frame, at most ${MOST_MS}`);
      return `${ms.toFixed(0)} ms${ms > SLOW_MS ? `, SLOW: more than ${SLOW_MS}` : ""}`;
    });
    await check("does not scroll sideways, and on a narrow page no table does", async () => {
      const overhang = await page.evaluate(async () => {
        for (const more of document.querySelectorAll("details")) more.open = true;
        await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
        const room = document.documentElement.clientWidth;
        const cut = room < 500 && [...document.querySelectorAll(".scroll")].find((box) => box.scrollWidth > box.clientWidth + 1);
        if (cut) return `a table of ${cut.scrollWidth} px in ${cut.clientWidth}: ${cut.textContent.slice(0, 60)}`;
        const widest = Math.max(document.documentElement.scrollWidth, document.body.scrollWidth);
        const culprit = [...document.body.querySelectorAll("*")].filter((n) => !n.closest(".scroll, svg")).find((n) => n.getBoundingClientRect().right > room + 1);
        for (const more of document.querySelectorAll("details")) more.open = false;
        return widest > room ? `${widest} px in ${room}, from ${culprit?.tagName}.${culprit?.className}` : "";
      });
      must(!overhang, overhang);
    });
    await texts(page);
    if (viewport === wide) {
      await order(page, name);
      await particulars(page, name);
      await files(page);
      await figures(page);
      if (points) await holdsPoints(page, points);
      await themes(page);
    } else {
      await check("a finger reads every figure", async () => {
        for (const id of await figuresOf(page)) {
          const box = await boxOf(page, id);
          await page.touchscreen.tap(box.x + box.width * 0.4, box.y + box.height / 2);
          const values = await readOut(page, id);
          must(full(values), `${id}: the read-out is empty: ${JSON.stringify(values)}`);
        }
      });
    }
    await quiet(tab);
    if (viewport === wide) await policy(page);
    await tab.close();
    const shade = await open(browser, file, viewport, { "prefers-color-scheme": "dark", "prefers-reduced-motion": "reduce" });
    await dark(browser, shade.page);
    await shade.close();
    const fresh = await open(browser, file, viewport, { "prefers-reduced-motion": "reduce" });
    await accessible(fresh.page);
    await fresh.close();
  }
  where = name;
  if ((await readFile(file, "utf8")).includes('id="animation"')) await animation(browser, file);
}

const browser = await puppeteer.launch({
  executablePath: chromium, headless: true,
  // As root, in a container, Chromium has no sandbox.
  args: process.getuid?.() === 0 ? ["--no-sandbox"] : [],
});
try {
  for (const page of pages) await tryPage(browser, page);
} catch (error) {
  failed++;
  console.log(`FAIL  ${where}: ${error.message}`);
} finally {
  await browser.close();
}
console.log(`${passed} passed, ${failed} failed`);
process.exitCode = failed ? 1 : 0;
