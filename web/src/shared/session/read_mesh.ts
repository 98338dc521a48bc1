// SPDX-License-Identifier: GPL-3.0-or-later
import { readPly } from '../../jobs/mesh_reader';
import type { ShadedMesh } from '../panels/shaded_mesh';

/** Reads a mesh and looks for its creases, both in workers: drawing it does not stop the page then. */
export async function readMesh(bytes: Uint8Array<ArrayBuffer>): Promise<ShadedMesh> {
  // The view comes with the craft's page; whoever reads a mesh is about to show it.
  const [mesh, { prepareShading }] = await Promise.all([readPly(bytes), import('../../view')]);
  return { ...mesh, shading: await prepareShading(mesh) };
}
