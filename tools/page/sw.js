/* The page without a network: its files are stored when it is first opened, detectors when they are first used.
 *
 * What is stored is given from the store, so that the page needs the server once.  tools/web writes a hash of all files
 * over BUILD: a changed page has another service worker, which stores it anew. */

const BUILD = "BUILD";
const STORE = `edmlift-${BUILD}`;
const DETECTORS = "edmlift-detectors"; // their folders have their version in the name

async function install() {
  const list = await fetch("files.json", { cache: "no-cache" });
  const store = await caches.open(STORE);
  await store.put("files.json", list.clone());
  const { core } = await list.json();
  await store.addAll(core.map((path) => new Request(path, { cache: "no-cache" })));
  await self.skipWaiting();
}

/** Deletes what older pages stored. */
async function activate() {
  const names = await caches.keys();
  const old = names.filter((name) => name.startsWith("edmlift-") && ![STORE, DETECTORS].includes(name));
  await Promise.all(old.map((name) => caches.delete(name)));
  const list = await (await caches.open(STORE)).match("files.json");
  const { detectors } = await list.json();
  const used = new Set(Object.values(detectors).map(({ folder }) => new URL(folder, self.registration.scope).href));
  const store = await caches.open(DETECTORS);
  for (const request of await store.keys())
    if (!used.has(new URL(".", request.url).href)) await store.delete(request);
  await self.clients.claim();
}

/** Where a file is kept once it was loaded: networks and detectors; undefined: nowhere, because it is not ours. */
function storeOf(address) {
  const path = address.startsWith(self.registration.scope) ? address.slice(self.registration.scope.length) : "";
  if (path.startsWith("detectors/files/")) return DETECTORS;
  return path.startsWith("lift/") ? STORE : undefined;
}

async function answer(request) {
  const stored = await caches.match(request, { ignoreSearch: true });
  if (stored) return stored;
  const response = await fetch(request);
  const name = storeOf(request.url);
  if (response.ok && name) await (await caches.open(name)).put(request, response.clone());
  return response;
}

self.addEventListener("install", (event) => event.waitUntil(install()));
self.addEventListener("activate", (event) => event.waitUntil(activate()));
self.addEventListener("fetch", (event) => {
  const { request } = event;
  const isOurs = new URL(request.url).origin === self.location.origin;
  if (isOurs && request.method === "GET") event.respondWith(answer(request));
});
