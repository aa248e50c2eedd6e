/* Files that are loaded once: a detector is kept on the device, also for when there is no network. */

const STORE = "edmlift-detectors"; // the service worker looks in there as well

/** Loads files that are not stored yet.  The service worker stores what passes it; before it is there, on the first visit,
 * they are stored here.
 *   files     [{ path, bytes }]
 *   progress  called with the bytes that are there and those wanted */
export async function fetchAll(files, progress) {
  const wanted = files.reduce((sum, { bytes }) => sum + bytes, 0);
  let there = 0;
  for (const { path, bytes } of files) {
    if (!(await isStored(path))) await fetchOne(path, (got) => progress(there + Math.min(got, bytes), wanted));
    there += bytes;
    progress(there, wanted);
  }
}

async function isStored(path) {
  return "caches" in self && Boolean(await caches.match(path));
}

async function fetchOne(path, progress) {
  const response = await fetch(path);
  if (!response.ok) throw new Error(`${path}: ${response.status} ${response.statusText}`);
  const here = "caches" in self && !navigator.serviceWorker?.controller;
  const storing = here && (await caches.open(STORE)).put(path, response.clone());
  const reader = response.body.getReader();
  let got = 0;
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    got += part.value.length;
    progress(got);
  }
  await storing;
}
