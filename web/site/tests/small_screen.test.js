// A finger drags on a small screen, and nothing is wider than the screen.
import assert from "node:assert/strict";
import test, { after, before } from "node:test";
import { skip } from "./browser.js";
import { pictured, seen, settled, visiting } from "./visit.js";

const { opened, begin, end } = visiting();
before(begin);
after(end);

test("a finger drags on a small screen", { skip }, async () => {
    const { page, consoleMessages } = await opened({ viewport: { width: 360, height: 640 }, hasTouch: true, isMobile: true });
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= 360));
    const hand = await seen(page, "left_hand");
    const touch = await page.context().newCDPSession(page);
    const send = (type, x, y) => touch.send("Input.dispatchTouchEvent", { type, touchPoints: type === "touchEnd" ? [] : [{ x, y }] });
    await send("touchStart", hand.x, hand.y);
    for (let k = 1; k <= 30; k += 1) await send("touchMove", hand.x - k, hand.y + k);
    await send("touchEnd");
    await settled(page);
    const moved = await seen(page, "left_hand");
    assert.ok(Math.hypot(moved.x - hand.x, moved.y - hand.y) > 20, `${moved.x - hand.x}, ${moved.y - hand.y}`);
    await pictured(page, "web-small.png");
    assert.deepEqual(consoleMessages, []);
    await page.close();
});
