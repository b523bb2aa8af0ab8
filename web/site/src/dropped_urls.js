// Dropped files under the names by which other files refer to them.
import * as THREE from "three";

/** Picture of one white pixel, for missing pictures. */
const WHITE = "data:image/gif;base64,R0lGODlhAQABAIAAAP///wAAACwAAAAAAQABAAACAkQBADs=";

/** A loading manager of three.js that sends no request to a server. */
export function managerOf(files) {
    const urls = new Map();
    const manager = new THREE.LoadingManager();
    manager.setURLModifier((url) => {
        if (/^(data|blob):/.test(url)) return url;
        const name = decodeURIComponent(url).split("/").pop();
        if (!(name in files)) return WHITE;
        if (!urls.has(name)) urls.set(name, URL.createObjectURL(new Blob([files[name]])));
        return urls.get(name);
    });
    return { manager, forget: () => urls.forEach((url) => URL.revokeObjectURL(url)) };
}
