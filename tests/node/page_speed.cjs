// Open a page in a browser (its path first) and measure it: milliseconds to the first picture, frames a second of sliders.
const {chromium} = require("playwright-core");

// Run in the page: move a slider a little in every frame for so long; how many frames were drawn in a second?
const slide = ([id, milliseconds]) => new Promise((done) => {
  const slider = document.getElementById(id), low = +slider.min, high = +slider.max, start = performance.now();
  let frames = 0, longest = 0, last = start;
  const step = (now) => {
    if (frames) longest = Math.max(longest, now - last);
    last = now;
    if (now - start >= milliseconds) return done({fps: frames / (now - start) * 1000, longest});
    frames += 1;
    slider.value = low + (high - low) * ((now - start) / milliseconds);
    slider.dispatchEvent(new Event("input"));
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
});

(async () => {
  const [executablePath, file] = process.argv.slice(2);
  const browser = await chromium.launch({executablePath, args: ["--no-sandbox"]});
  const page = await browser.newPage({viewport: {width: 1280, height: 800}});
  await page.goto("about:blank");
  await page.goto(`file://${file}`);
  await page.waitForFunction(() => performance.getEntriesByName("first-contentful-paint").length);
  const measured = await page.evaluate(() => ({
    paint: performance.getEntriesByName("first-contentful-paint")[0].startTime,
    drawn: performance.getEntriesByName("drawn")[0].startTime,
  }));
  const sliders = {};
  for (const id of ["fold", "layers", "apart"]) sliders[id] = await page.evaluate(slide, [id, 3000]);
  await browser.close();
  console.log(JSON.stringify({...measured, sliders}));
})();
