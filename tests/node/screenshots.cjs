// Take pictures of a page and of foldcut serve: the browser's path, the page's file, the server's address, a folder.
const {chromium} = require("playwright-core");

(async () => {
  const [executablePath, file, address, folder] = process.argv.slice(2);
  const browser = await chromium.launch({executablePath, args: ["--no-sandbox"]});
  const page = await browser.newPage({viewport: {width: 1000, height: 680}});
  await page.goto(`file://${file}`);
  await page.click("#after");
  await page.evaluate(() => { document.getElementById("fold").value = 70; document.getElementById("fold").dispatchEvent(new Event("input")); });
  await page.waitForTimeout(300);
  await page.screenshot({path: `${folder}/page.png`});

  await page.setViewportSize({width: 1200, height: 940});
  await page.goto(address);
  await page.waitForSelector("#sample option[value=star]", {state: "attached"});
  await page.click("#drawing summary");
  const board = page.locator("#board"), {width, height} = await board.boundingBox();
  for (const [x, y] of [[0.15, 0.8], [0.85, 0.8], [0.6, 0.5], [0.5, 0.12]]) await board.click({position: {x: x * width, y: y * height}});
  await page.selectOption("#profile", "glowforge");
  await page.click("#go");
  await page.waitForSelector("#taking:not([hidden])", {timeout: 60000});
  await page.frameLocator("iframe").last().locator("#facts").waitFor();
  await page.waitForTimeout(500);
  await page.evaluate(() => window.scrollTo(0, 0));
  await page.screenshot({path: `${folder}/serve.png`});
  await browser.close();
})();
