// Take pictures of a page and of foldcut serve: the browser's path, the page's file, the server's address, a folder.
const {chromium} = require("playwright-core");

(async () => {
  const [executablePath, file, address, folder] = process.argv.slice(2);
  const browser = await chromium.launch({executablePath, args: ["--no-sandbox"]});
  const page = await browser.newPage({viewport: {width: 1200, height: 760}});
  await page.goto(`file://${file}`);
  await page.evaluate(() => { document.getElementById("fold").value = 160; document.getElementById("fold").dispatchEvent(new Event("input")); });
  await page.waitForTimeout(1000);
  await page.screenshot({path: `${folder}/page.png`});

  const ended = async (act) => {
    await page.evaluate(() => { const line = document.getElementById("said"); if (line) line.textContent = ""; });
    await act();
    await page.waitForFunction(() => document.getElementById("said").textContent.startsWith("Verified"), null, {timeout: 120000});
  };
  await page.setViewportSize({width: 1400, height: 900});
  await ended(() => page.goto(address));
  await ended(() => page.click("[data-sample=heart]"));
  await page.evaluate(() => { document.getElementById("fold").value = 160; document.getElementById("fold").dispatchEvent(new Event("input")); });
  await page.waitForTimeout(1500);
  await page.screenshot({path: `${folder}/serve.png`});
  await browser.close();
})();
