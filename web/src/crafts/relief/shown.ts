// SPDX-License-Identifier: GPL-3.0-or-later
// What the relief room shows.
import type { Report } from '../../jobs/contract';
import type { ShadedMesh } from '../../shared/panels/shaded_mesh';
import type { ShownWork } from '../../shared/session/previews';
import type { MeshData } from '../../view';

export interface Shown extends ShownWork {
  readonly mesh: ShadedMesh;
  /** Behind it, where that is no flat plate. */
  readonly base: MeshData | null;
}

/** The front of the solid in one light. */
export interface LitRelief {
  readonly positions: Float32Array;
  readonly indices: Uint32Array;
  /** As a screen shows it, 0 to 1, per vertex. */
  readonly brightness: Float32Array;
  readonly report: Report;
  /** The relief that it is the light on. */
  readonly of: Shown;
}
