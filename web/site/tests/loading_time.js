// Times until the first picture and until a drag is possible at 9 Mb/s, in milliseconds: `node web/site/tests/loading_time.js`
import { skip, started } from "./browser.js";

const NETWORK = { offline: false, latency: 40, downloadThroughput: 9e6 / 8, uploadThroughput: 3e6 / 8 };

if (skip) throw new Error(skip);
const { browser, address, close } = await started();
for (let run = 1; run <= 3; run += 1) {
    // Each context has an empty cache.
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, deviceScaleFactor: 0.5 });
    const page = await context.newPage();
    const session = await context.newCDPSession(page);
    await session.send("Network.enable");
    await session.send("Network.emulateNetworkConditions", NETWORK);
    await page.addInitScript(() => {
        const entries = new PerformanceObserver((list) => (globalThis.pictured ??= list.getEntries().find(({ element }) => element?.closest("#poster"))?.startTime));
        entries.observe({ type: "largest-contentful-paint", buffered: true });
    });
    await page.goto(address, { waitUntil: "commit" });
    await page.waitForFunction(() => globalThis.kinoptPage?.frames.length > 0, undefined, { polling: 20 });
    const [picture, drag] = await page.evaluate(() => [globalThis.pictured, performance.now()]);
    console.log(`${run}: first picture ${picture?.toFixed(0)}, drag ${drag.toFixed(0)}`);
    await context.close();
}
await close();
