// Use the page of foldcut serve in a browser: its path, the page's address, a drawing; print what is seen as JSON.
const {chromium} = require("playwright-core");
const axe = require("axe-core");
const fs = require("fs");

const DESK = {width: 1400, height: 900}, PHONE = {width: 390, height: 844};

(async () => {
  const [executablePath, address, drawing] = process.argv.slice(2);
  const browser = await chromium.launch({executablePath, args: ["--no-sandbox"]});
  const page = await browser.newPage({viewport: DESK});
  const complaints = [], requests = [];
  const watch = (one) => {
    one.on("console", (message) => ["error", "warning"].includes(message.type()) && !message.text().includes("GL Driver Message") && complaints.push(message.text()));
    one.on("pageerror", (error) => complaints.push(error.message));
    one.on("request", (request) => requests.push(request.url()));
  };
  watch(page);

  const said = () => page.textContent("#said");
  /** Wait until a pattern is there, or an error, of what was done last. */
  const ended = async (act) => {
    await page.evaluate(() => { const line = document.getElementById("said"); if (line) line.textContent = ""; });
    await act();
    await page.waitForFunction(() => /^(Verified|There is no)/.test(document.getElementById("said").textContent), null, {timeout: 60000});
    return {
      said: await said(), name: await page.textContent("#name"), lines: await page.locator("#pattern line").count(),
      folds: +(await page.locator("#numbers div", {has: page.locator("dt:text-is('folds')")}).locator("dd").textContent()),
    };
  };
  const saved = async (name) => {
    await page.click("#download");
    const [download] = await Promise.all([page.waitForEvent("download", {timeout: 60000}), page.click(`[data-file="${name}"]`)]);
    await page.keyboard.press("Escape");
    seen.names.push(download.suggestedFilename());
    return fs.readFileSync(await download.path()).toString("base64");
  };
  const look = async () => {
    seen.heights.push(await page.evaluate(() => document.documentElement.scrollHeight));
    await page.evaluate(axe.source);
    const found = await page.evaluate(() => axe.run({iframes: false}));
    seen.serious.push(...found.violations.filter((v) => ["serious", "critical"].includes(v.impact)).map((v) => v.id));
  };

  const seen = {names: [], heights: [], serious: [], reached: []};
  seen.first = await ended(() => page.goto(address));
  await look();
  await page.evaluate(() => document.activeElement.blur());
  for (let tab = 0; tab < 90; tab++) {
    await page.keyboard.press("Tab");
    const id = await page.evaluate(() => { const now = document.activeElement; return now.dataset.sample ? "sample" : now.dataset.corner ? "corner" : now.id || now.localName; });
    if (id === "body") break;
    if (!seen.reached.includes(id)) seen.reached.push(id);
  }
  seen.triangle = await ended(() => page.click("[data-sample=triangle]"));
  seen.pdf = await saved("pattern.pdf");
  await page.click("details:has(#profile) summary");
  await ended(() => page.selectOption("#profile", "laser-dxf"));
  seen.dxf = await saved("job.dxf");
  seen.svg = await saved("pattern.svg");
  await look();

  seen.chosen = await ended(() => page.setInputFiles("#file", drawing));
  const dropped = await page.evaluateHandle((text) => {
    const carried = new DataTransfer();
    carried.items.add(new File([text], "dropped one.json", {type: "application/json"}));
    return carried;
  }, fs.readFileSync(drawing, "utf8"));
  await page.dispatchEvent("main", "dragover", {dataTransfer: dropped});
  seen.over = await page.locator("body.dropping").count();
  seen.dropped = await ended(() => page.dispatchEvent("main", "drop", {dataTransfer: dropped}));
  await saved("pattern.fold");
  seen.typed = await ended(() => page.fill("#text", "I"));

  await page.click("#new");
  const board = page.locator("#board"), at = async ([x, y]) => page.evaluate(([u, v]) => {
    const {x: left, y: top} = new DOMPoint(u, v).matrixTransform(document.getElementById("board").getScreenCTM());
    return [left, top];
  }, [x, 100 - y]);
  seen.drawn = await ended(async () => { for (const corner of [[20, 20], [80, 20], [40, 80]]) await page.mouse.click(...await at(corner)); });
  seen.corners = await page.inputValue("#corners");
  const handle = await board.locator("circle").last().boundingBox(), middle = [handle.x + handle.width / 2, handle.y + handle.height / 2];
  seen.moved = await ended(async () => {
    await page.mouse.move(...middle);
    await page.mouse.down();
    await page.mouse.move(middle[0] + 30, middle[1] + 12, {steps: 4});
    await page.mouse.up();
  });
  seen.after = await page.inputValue("#corners");
  const other = await browser.newPage();
  watch(other);
  await other.goto(page.url());
  await other.waitForSelector("body[data-ready]");
  seen.shared = await other.inputValue("#corners");
  await other.close();
  await page.click("#keep");
  seen.kept = [await page.isVisible("#kept")];
  await look();
  seen.kept.push(await page.isVisible("#kept svg"));
  await page.click("#keep");
  seen.kept.push(await page.isVisible("#kept"));

  await ended(async () => { await page.fill("#sheet", "nonsense"); await page.keyboard.press("Tab"); });
  seen.bad = await page.textContent("#wrong");
  seen.stale = (await page.locator("body.stale").count()) === 1 && await page.isVisible("#wrong");
  await page.evaluate(() => { document.getElementById("sheet").value = "a4"; });
  await page.focus("#level");
  await page.keyboard.press("Home");
  seen.easy = await page.textContent("#level-words");
  await page.click("[data-sample=swan]");
  await page.click("#stop");
  await page.waitForFunction(() => document.getElementById("said").textContent === "Stopped.");
  seen.stopped = await said();
  await page.setViewportSize(PHONE);
  seen.wide = await page.evaluate(() => document.documentElement.scrollWidth);
  seen.top = await page.evaluate(() => document.getElementById("pattern-pane").getBoundingClientRect().top);
  await browser.close();
  const foreign = requests.filter((url) => !url.startsWith(address) && !/^(data|about|blob):/.test(url));
  const refused = (text) => text.includes("400 (Bad Request)"); // Chromium's own word on the sheet that is none
  console.log(JSON.stringify({...seen, refused: complaints.filter(refused).length, complaints: complaints.filter((text) => !refused(text)), foreign}));
})();
