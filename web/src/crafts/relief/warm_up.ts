// SPDX-License-Identifier: GPL-3.0-or-later
import type { Services } from '../../shared/session/services';

/** Browsers compile WASM quickly first and well only after it has run: a small relief made while the start
 *  screen is read takes half a second off the first preview. Abort it when the solver is wanted. */
export async function warmUp({ browser, catalog }: Services, signal: AbortSignal): Promise<void> {
  const samples = [...(catalog.value?.samples ?? [])];
  const [least] = samples.sort((a, b) => a.default_vertices - b.default_vertices);
  if (browser.kind !== 'wasm' || least === undefined) return;
  const inputs = { mesh: { sample: least.name, vertices: 1500 } };
  const job = { operation: 'relief', parameters: {}, inputs, outputs: ['relief.ply'] };
  await browser.run(job, { signal }).catch(() => undefined);
}
