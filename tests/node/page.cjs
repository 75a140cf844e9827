// Open pages in a browser (its path first), work their controls, and print what is seen, one entry a page, as JSON.
const {chromium} = require("playwright-core");
const axe = require("axe-core");

const look = async (browser, file) => {
  const page = await browser.newPage({viewport: {width: 390, height: 844}});
  const complaints = [], requests = [];
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(`file://${file}`);
  const first = await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime ?? 0);
  const drawn = () => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  const text = (selector) => drawn().then(() => page.textContent(selector));
  const picture = () => drawn().then(() => page.locator("#folded").screenshot().then((image) => image.toString("base64")));
  const seen = {facts: await page.textContent("#facts"), first, wide: await page.evaluate(() => document.documentElement.scrollWidth)};
  const folded = await picture();
  await page.focus("#fold");
  await page.keyboard.press("Home");
  const flat = await picture();
  seen.flat = await text("#stretch");
  for (let step = 0; step < 10; step++) await page.keyboard.press("ArrowRight");
  seen.between = await text("#stretch");
  await page.keyboard.press("End");
  seen.folded = await text("#stretch");
  await page.check("#cut");
  const cut = await picture();
  await page.focus("#layers");
  await page.keyboard.press("Home");
  seen.layers = await page.textContent("#layer-count");
  const one = await picture();
  seen.pictures = new Set([folded, flat, cut, one]).size;
  await page.uncheck("[data-layer=M]");
  seen.mountains = await page.locator("[data-name=M] line").count();
  seen.mountainsShown = await page.locator("[data-name=M] line:visible").count();
  await page.check("[data-layer=M]");
  await page.click("#after");
  seen.crease = await page.textContent("#tip");
  await page.evaluate(axe.source);
  const found = await page.evaluate(() => axe.run());
  seen.serious = found.violations.filter((v) => ["serious", "critical"].includes(v.impact)).map((v) => v.id);
  seen.frame = await page.evaluate(() => {
    const start = performance.now();
    for (let at = 20; at < 50; at++) foldcut.frame(at);
    return (performance.now() - start) / 30;
  });
  await page.close();
  return {...seen, complaints, requests: requests.filter((url) => !url.startsWith("file://") && !url.startsWith("data:"))};
};

(async () => {
  const [executablePath, ...files] = process.argv.slice(2);
  const browser = await chromium.launch({executablePath, args: ["--no-sandbox"]});
  const pages = [];
  for (const file of files) pages.push(await look(browser, file));
  await browser.close();
  console.log(JSON.stringify(pages));
})();
