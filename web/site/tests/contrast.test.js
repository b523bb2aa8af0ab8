// Contrast of text in the light and dark schemes: at least 4.5 to 1, as in WCAG 2.2 (1.4.3).
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";

const styles = ["../palette.css", "../docs/page.css"].map((path) => readFileSync(new URL(path, import.meta.url), "utf8")).join("\n");
const colours = (lines) => Object.fromEntries(lines.flatMap((line) => [...line.matchAll(/--([\w-]+): (#\w{6})/g)].map(([, name, colour]) => [name, colour])));
const roots = styles.split("\n").filter((line) => line.includes(":root {"));
const light = colours(roots.filter((line) => !line.startsWith("@media")));
const dark = { ...light, ...colours(roots.filter((line) => line.startsWith("@media"))) };

const luminance = (colour) =>
    [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16) / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))
        .reduce((sum, value, k) => sum + value * [0.2126, 0.7152, 0.0722][k], 0);
function contrast(one, other) {
    const [dim, bright] = [one, other].map(luminance).sort((a, b) => a - b);
    return (bright + 0.05) / (dim + 0.05);
}

for (const [name, scheme] of Object.entries({ light, dark })) {
    test(`contrast of text and code, ${name}`, () => {
        for (const back of ["back", "code"]) {
            for (const word of ["text", "mark", "bad", "soft", "key", "text-of", "number", "comment", "type"]) {
                assert.ok(contrast(scheme[word], scheme[back]) >= 4.5, `${word} on ${back}: ${contrast(scheme[word], scheme[back]).toFixed(2)}`);
            }
        }
    });
}
