// SPDX-License-Identifier: GPL-3.0-or-later
// What views show beyond the sheet itself, read when a view asks for it: the print on the sheet, the draft of
// the model.
import { effect, signal } from '@preact/signals';
import { readPly, readPrinted } from '../../jobs/mesh_reader';
import type { MeshData } from '../../view';
import { sameRequest } from '../../shared/session/craft_document';
import { bytesToSave } from './make_product';
import { previewPrint } from './preview_print';
import type { Product } from '../../shared/session/products';
import { moulding, printing } from './thermoform_document';
import type { Formed, ThermoformSession } from './thermoform_session';
import type { View } from './views';
import { view } from './views';

/** What it was read for and from: another sheet, or a print made with other settings, is not shown by it. */
interface ReadFor {
  readonly of: Formed;
  /** The file's hash. */
  readonly file: string;
}

export interface Extras {
  /** The print, laid onto the sheet. */
  readonly printed:
    | (ReadFor & {
        readonly uvs: Float32Array;
        readonly texture: ImageBitmap;
        /** Of the picture; null for a preview's, which nobody prints. */
        readonly url: string | null;
      })
    | null;
  /** The model with its draft, in the machine. */
  readonly draft: (ReadFor & { readonly mesh: MeshData }) | null;
}

const none: Extras = { printed: null, draft: null };
/** A slider that moves again within this was not at rest: nothing is made of where it was. */
const rest_ms = 400;

const hashOf = (product: Product | null, output: string): string | null =>
  product?.outputs[output]?.blob ?? null;
const isOf = (read: ReadFor | null, formed: Formed, file: string | null): boolean =>
  read !== null && read.of === formed && read.file === file;

/** Follows the session; what a view needs and nobody has made is made once. */
export function watchExtras(session: ThermoformSession) {
  const extras = signal<Extras>(none);
  const tried = new Set<string>();
  /** Once nothing else runs. What is given back calls it off. */
  const makeLater = (operation: string, output: string, label: string, wait_ms: number) => {
    const key = JSON.stringify([operation, session.document.value.parameters, session.result.value?.id]);
    if (session.activity.value.kind !== 'idle' || tried.has(key)) return undefined;
    const make = () => {
      tried.add(key);
      void bytesToSave(session, operation, output, label);
    };
    const waiting = setTimeout(make, wait_ms);
    return () => clearTimeout(waiting);
  };
  let urls: string[] = [];
  const forget = () => {
    for (const url of urls) URL.revokeObjectURL(url);
    urls = [];
  };

  const readPrint = async ({ of, file }: ReadFor): Promise<void> => {
    const read = await readPrinted(await session.services.projects.blobs.read(file));
    if (read.positions.length !== of.sheet.positions.length) return; // of another sheet
    const picture = new Blob([read.picture], { type: read.media_type });
    const texture = await createImageBitmap(picture, { imageOrientation: 'flipY' });
    if (session.shown.value !== of || hashOf(session.print.value, 'formed.glb') !== file) return;
    forget();
    const url = URL.createObjectURL(picture);
    urls.push(url);
    extras.value = { ...extras.peek(), printed: { of, file, uvs: read.uvs, texture, url } };
  };
  /** The model's own colours on a preview's sheet: made in the page, kept nowhere. */
  const printPreview = async (of: Formed): Promise<void> => {
    const read = await previewPrint(session, of);
    if (read === null || read.positions.length !== of.sheet.positions.length) return;
    const picture = new Blob([read.picture], { type: read.media_type });
    const texture = await createImageBitmap(picture, { imageOrientation: 'flipY' });
    if (session.shown.value !== of) return;
    extras.value = { ...none, printed: { of, file: '', uvs: read.uvs, texture, url: null } };
  };
  const readDraft = async ({ of, file }: ReadFor): Promise<void> => {
    const { positions, indices, attributes } = await readPly(
      await session.services.projects.blobs.read(file),
    );
    if (session.shown.value !== of || hashOf(session.mould.value, 'draft.ply') !== file) return;
    const draft_deg = attributes['draft_deg'] ?? new Float32Array(positions.length / 3);
    const overhang_deg = draft_deg.map((angle) => -angle);
    const mesh = { positions, indices, attributes: { overhang_deg } };
    extras.value = { ...extras.peek(), draft: { of, file, mesh } };
  };

  let looked: View | null = null;
  const stop = effect(() => {
    const of = session.shown.value;
    const print = hashOf(session.print.value, 'formed.glb');
    const mould = hashOf(session.mould.value, 'draft.ply');
    const wanted = view.value;
    const wait_ms = wanted === looked ? rest_ms : 0; // a view just chosen waits for nothing
    looked = wanted;
    const result = session.result.value;
    // While another result is being read, print and mould are that one's already.
    if (of?.kind !== 'full' || result === null || !sameRequest(result, { ...of, mesh: of.from })) {
      const painted = of?.kind === 'preview' && extras.peek().printed?.of === of;
      if (extras.peek() !== none && !painted) extras.value = none;
      if (of?.kind !== 'preview' || wanted !== 'texture' || painted || !session.hasColours.value)
        return undefined;
      const waiting = setTimeout(() => void printPreview(of).catch(() => undefined), wait_ms);
      return () => clearTimeout(waiting);
    }
    const { printed, draft } = extras.peek();
    if (wanted === 'texture' && !isOf(printed, of, print) && session.operationNamed(printing)) {
      if (printed) extras.value = { ...extras.peek(), printed: null };
      if (print === null) return makeLater(printing, 'formed.glb', 'print', wait_ms);
      // What is lost is made again.
      void readPrint({ of, file: print }).catch(() => makeLater(printing, 'formed.glb', 'print', 0));
    }
    if (wanted === 'undercut' && !isOf(draft, of, mould) && session.operationNamed(moulding)) {
      if (draft) extras.value = { ...extras.peek(), draft: null };
      if (mould === null) return makeLater(moulding, 'draft.ply', 'draft map', wait_ms);
      void readDraft({ of, file: mould }).catch(() => makeLater(moulding, 'draft.ply', 'draft map', 0));
    }
    return undefined;
  });
  return {
    extras,
    dispose: () => {
      stop();
      forget();
    },
  };
}
