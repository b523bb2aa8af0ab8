// Checks of arguments before the module reads them: the module trusts lengths and types, and a wrong one would trap in
// it. Each function returns its argument, or throws a TypeError that names the expected type.

const kind = (value) => {
    if (value === undefined) return "is missing";
    if (value === null || Number.isNaN(value)) return `is ${value}`;
    if (typeof value !== "object") return `is a ${typeof value}`;
    return `is of ${value.constructor?.name ?? "no class"}`;
};
const typeErrorOf = (what, value, name) => new TypeError(`${name} ${kind(value)}, expected ${what}`);
const isNumber = (value) => typeof value === "number";
/** Objects whose length is set by the engine, not by a caller. */
const isList = (value) => Array.isArray(value) || (ArrayBuffer.isView(value) && !(value instanceof DataView));

/** A list whose elements all have the type; typed arrays of numbers are accepted unchanged. */
function list(value, name, what, isElement, elementType) {
    if (!isList(value) || value instanceof BigInt64Array || value instanceof BigUint64Array) throw typeErrorOf(what, value, name);
    if (!Array.isArray(value)) return value;
    // By index, because iteration methods skip missing elements.
    for (let k = 0; k < value.length; k += 1) if (!isElement(value[k])) throw typeErrorOf(elementType, value[k], `${name}[${k}]`);
    return value;
}

export const numbers = (value, name) => list(value, name, "a list of numbers", isNumber, "a number");

export function number(value, name) {
    if (!isNumber(value) || Number.isNaN(value)) throw typeErrorOf("a number", value, name);
    return value;
}

export function whole(value, name) {
    if (!Number.isInteger(value) || value < 0 || value > 0xffffffff) throw new TypeError(`${name} is ${value}, expected a whole number of at least 0`);
    return value;
}

export function string(value, name) {
    if (typeof value !== "string") throw typeErrorOf("a string", value, name);
    return value;
}

export function strings(value, name) {
    if (!Array.isArray(value)) throw typeErrorOf("a list of strings", value, name);
    return list(value, name, "a list of strings", (element) => typeof element === "string", "a string");
}

export function array(value, name) {
    if (!Array.isArray(value)) throw typeErrorOf("an array", value, name);
    return value;
}

export function bytes(value, name) {
    if (Array.isArray(value)) return numbers(value, name);
    // Also accepts an array of another page.
    if (value?.[Symbol.toStringTag] !== "Uint8Array" || !isList(value)) throw typeErrorOf("a Uint8Array", value, name);
    return value;
}

/** Largest size of a list in the module, bytes. */
const MAX_BYTES = 0x7fffffff;

/**
 * Wraps an allocation function of the module: a trap becomes a RangeError. `sizeAt` is the index of the size argument.
 */
export const allocating = (allocate, sizeAt) => (...sizes) => {
    const bytes = sizes[sizeAt];
    const full = () => new RangeError(`${bytes} bytes exceed the memory of the module`);
    if (bytes > MAX_BYTES) throw full();
    try {
        return allocate(...sizes);
    } catch (error) {
        throw error instanceof WebAssembly.RuntimeError ? full() : error;
    }
};

export function instance(value, name, type) {
    if (!(value instanceof type)) throw typeErrorOf(`a ${type.name}`, value, name);
    return value;
}
