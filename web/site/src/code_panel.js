// The panel with the JavaScript behind a scene, and the link to its guide.
import { CODE } from "./code.js";
import { SCENES } from "./models.js";

/** Shows and hides the panel by its button; `show` selects the scene. */
export function codePanel(panel, button) {
    const [text, copy, guide] = ["code", "button", "a"].map((name) => panel.querySelector(name));
    button.onclick = () => {
        panel.hidden = !panel.hidden;
        button.setAttribute("aria-expanded", String(!panel.hidden));
    };
    copy.onclick = async () => {
        await navigator.clipboard?.writeText(text.textContent);
        copy.textContent = "Copied";
        setTimeout(() => (copy.textContent = "Copy"), 1500);
    };
    return {
        show(scene) {
            button.hidden = scene === undefined;
            if (scene === undefined) {
                panel.hidden = true;
                return;
            }
            text.textContent = CODE[scene];
            guide.href = SCENES[scene].guide;
        },
    };
}
