export function startServe() {}
