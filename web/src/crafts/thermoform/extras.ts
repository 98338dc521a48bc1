// SPDX-License-Identifier: GPL-3.0-or-later
// What views show beyond the sheet itself, read when a view asks for it: the print on the sheet, the draft of
// the model.
import { effect, signal } from '@preact/signals';
import { readPly, readPrinted } from '../../jobs/mesh_reader';
import type { MeshData } from '../../view';
import { bytesToSave } from './make_product';
import type { Product } from '../common/products';
import { moulding, printing } from './thermoform_document';
import type { Formed, ThermoformSession } from './thermoform_session';
import { view } from './views';

export interface Extras {
  /** The print, laid onto the sheet `of`. */
  readonly printed: {
    readonly of: Formed;
    readonly uvs: Float32Array;
    readonly texture: ImageBitmap;
    readonly url: string;
  } | null;
  /** The model with its draft, in the machine. */
  readonly draft: MeshData | null;
}

const none: Extras = { printed: null, draft: null };

/** Follows the session; what a view needs and nobody has made is made once. */
export function watchExtras(session: ThermoformSession) {
  const extras = signal<Extras>(none);
  const tried = new Set<string>();
  const make = (operation: string, output: string, label: string): void => {
    const key = JSON.stringify([operation, session.document.peek().parameters, session.result.peek()?.id]);
    if (tried.has(key) || session.activity.value.kind !== 'idle') return;
    tried.add(key);
    void bytesToSave(session, operation, output, label);
  };
  let urls: string[] = [];
  const forget = () => {
    for (const url of urls) URL.revokeObjectURL(url);
    urls = [];
  };

  const readPrint = async (print: Product, formed: Formed): Promise<void> => {
    const glb = print.outputs['formed.glb'];
    if (glb === undefined) return;
    const read = await readPrinted(await session.services.projects.blobs.read(glb.blob));
    if (read.positions.length !== formed.sheet.positions.length) return; // of another sheet
    const picture = new Blob([read.picture], { type: read.media_type });
    const texture = await createImageBitmap(picture, { imageOrientation: 'flipY' });
    if (session.shown.value !== formed) return;
    forget();
    const url = URL.createObjectURL(picture);
    urls.push(url);
    extras.value = { ...extras.peek(), printed: { of: formed, uvs: read.uvs, texture, url } };
  };
  const readDraft = async (mould: Product): Promise<void> => {
    const ply = mould.outputs['draft.ply'];
    if (ply === undefined) return;
    const { positions, indices, attributes } = await readPly(
      await session.services.projects.blobs.read(ply.blob),
    );
    const draft_deg = attributes['draft_deg'] ?? new Float32Array(positions.length / 3);
    const overhang_deg = draft_deg.map((angle) => -angle);
    extras.value = { ...extras.peek(), draft: { positions, indices, attributes: { overhang_deg } } };
  };

  const stop = effect(() => {
    const shown = session.shown.value;
    const { print, mould } = { print: session.print.value, mould: session.mould.value };
    const wanted = view.value;
    if (shown?.kind !== 'full' || session.result.value === null) {
      if (extras.peek() !== none) extras.value = none;
      return;
    }
    if (wanted === 'texture' && extras.peek().printed?.of !== shown && session.operationNamed(printing)) {
      if (print?.outputs['formed.glb']) void readPrint(print, shown).catch(() => undefined);
      else make(printing, 'formed.glb', 'print');
    }
    if (wanted === 'undercut' && extras.peek().draft === null && session.operationNamed(moulding)) {
      if (mould?.outputs['draft.ply']) void readDraft(mould).catch(() => undefined);
      else make(moulding, 'draft.ply', 'draft map');
    }
  });
  return {
    extras,
    dispose: () => {
      stop();
      forget();
    },
  };
}
