// Files that were dropped, under the names by which other files ask for them.
import * as THREE from "three";

/** A picture of one white point, for those that are not there. */
const WHITE = "data:image/gif;base64,R0lGODlhAQABAIAAAP///wAAACwAAAAAAQABAAACAkQBADs=";

/** A manager for three.js's loaders that never asks a server. */
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
