// Use the page of foldcut serve in a browser: its path, the page's address, a drawing; print what is seen as JSON.
const {chromium} = require("playwright-core");
const axe = require("axe-core");
const fs = require("fs");

(async () => {
  const [executablePath, address, drawing] = process.argv.slice(2);
  const browser = await chromium.launch({executablePath, args: ["--no-sandbox"]});
  const page = await browser.newPage({viewport: {width: 1100, height: 1300}});
  const complaints = [], requests = [];
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(address);
  await page.waitForSelector("#sample option[value=triangle]", {state: "attached"});

  const ended = async (words) => {
    await page.waitForFunction((text) => {
      const said = document.getElementById("said");
      return said.classList.contains("bad") || said.textContent.includes(text);
    }, words, {timeout: 60000});
    return {said: await page.textContent("#said"), report: await page.textContent("#report"), taking: await page.isVisible("#taking")};
  };
  const again = () => page.evaluate(() => { document.getElementById("said").textContent = ""; });
  const quick = () => ended("press Fold");
  const fold = async () => {
    await again();
    await page.click("#go");
    return {...await ended("Verified"), files: await page.locator("#files a").allTextContents()};
  };
  const saved = async (act) => {
    const [download] = await Promise.all([page.waitForEvent("download", {timeout: 60000}), act()]);
    return fs.readFileSync(await download.path()).toString("base64");
  };
  const serious = async () => {
    await page.evaluate(axe.source);
    const found = await page.evaluate(() => axe.run({iframes: false}));
    return found.violations.filter((v) => ["serious", "critical"].includes(v.impact)).map((v) => v.id);
  };

  const seen = {serious: await serious(), reached: []};
  for (let tab = 0; tab < 40; tab++) {
    await page.keyboard.press("Tab");
    const id = await page.evaluate(() => document.activeElement.id || document.activeElement.localName);
    if (id === "body") break;
    seen.reached.push(id);
  }
  await page.selectOption("#sample", "triangle");
  seen.quick = await quick();
  await page.selectOption("#effort", "fast");
  await page.selectOption("#profile", "laser-dxf");
  seen.sample = await fold();
  seen.zip = await saved(() => page.click("#files a:has-text('job.zip')"));
  seen.dxf = await saved(() => page.click("#files a:has-text('job.dxf')"));
  await page.selectOption("#more", "pattern.svg");
  seen.svg = await saved(() => page.click("#make"));
  seen.shown = await page.frameLocator("iframe").last().locator("#facts").textContent();
  seen.serious.push(...await serious());
  await page.setViewportSize({width: 390, height: 844});
  seen.wide = await page.evaluate(() => document.documentElement.scrollWidth);
  seen.serious.push(...await serious());
  await page.setViewportSize({width: 1100, height: 1300});

  await again();
  await page.setInputFiles("#file", drawing);
  seen.chosen = await quick();
  seen.file = await fold();

  await again();
  const dropped = await page.evaluateHandle((text) => {
    const carried = new DataTransfer();
    carried.items.add(new File([text], "dropped.json", {type: "application/json"}));
    return carried;
  }, fs.readFileSync(drawing, "utf8"));
  await page.dispatchEvent("#drop", "dragover", {dataTransfer: dropped});
  seen.over = await page.locator("#drop.over").count();
  await page.dispatchEvent("#drop", "drop", {dataTransfer: dropped});
  seen.dropped = await quick();
  seen.left = await page.inputValue("#file");
  seen.drop = await fold();

  await again();
  if (await page.isVisible("#text")) {
    await page.fill("#text", "I");
    seen.typed = await quick();
  }

  await again();
  await page.click("#drawing summary");
  const board = page.locator("#board");
  await board.scrollIntoViewIfNeeded();
  const {x: left, y: top, width, height} = await board.boundingBox();
  for (const [x, y] of [[0.2, 0.8], [0.8, 0.8], [0.4, 0.2]]) await board.click({position: {x: x * width, y: y * height}});
  seen.corners = await page.inputValue("#corners");
  seen.sketched = await quick();
  await page.mouse.move(left + 0.4 * width, top + 0.2 * height);
  await page.mouse.down();
  await page.mouse.move(left + 0.5 * width, top + 0.3 * height, {steps: 5});
  await page.mouse.up();
  seen.moved = await page.inputValue("#corners");
  seen.drawn = await fold();

  await again();
  await page.fill("#sheet", "nonsense");
  await page.click("#go");
  seen.bad = (await ended("Verified")).said;
  seen.stale = await page.isVisible("#result") || await page.locator("iframe").count();
  await page.fill("#sheet", "a4");
  await page.selectOption("#sample", "swan");
  await page.selectOption("#effort", "normal");
  await page.click("#go");
  await page.waitForFunction(() => /searching/.test(document.getElementById("stage").textContent) && document.getElementById("bar").value > 0, null, {timeout: 60000});
  seen.bar = await page.evaluate(() => document.getElementById("bar").value);
  await page.click("#stop");
  await page.waitForFunction(() => document.getElementById("said").textContent === "Cancelled.");
  seen.cancelled = await page.isHidden("#busy");
  await browser.close();
  const foreign = requests.filter((url) => !url.startsWith(address) && !url.startsWith("data:") && !url.startsWith("about:"));
  const refused = (text) => text.includes("400 (Bad Request)"); // Chromium's own word on the sheet that is none
  console.log(JSON.stringify({...seen, refused: complaints.filter(refused).length, complaints: complaints.filter((text) => !refused(text)), foreign}));
})();
