// SPDX-License-Identifier: GPL-3.0-or-later
import { batch, signal } from '@preact/signals';
import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import type { CraftResult } from '../../shared/session/craft_document';
import type { Product } from '../../shared/session/products';
import { watchExtras } from './extras';
import { bytesToSave } from './make_product';
import { previewPrint } from './preview_print';
import { moulding, printing } from './thermoform_document';
import type { Formed, ThermoformSession } from './thermoform_session';
import { view } from './views';

vi.mock('./make_product', () => ({ bytesToSave: vi.fn(() => Promise.resolve(null)) }));
vi.mock('./preview_print', () => ({
  previewPrint: vi.fn(() => Promise.resolve({ positions: [0, 0, 0], uvs: 'own', picture: 'own' })),
}));
vi.mock('../../jobs/mesh_reader', () => ({
  readPrinted: (bytes: string) => Promise.resolve({ positions: [0, 0, 0], uvs: bytes, picture: bytes }),
  readPly: (bytes: string) => Promise.resolve({ positions: bytes, indices: [], attributes: {} }),
}));

const formed = (size_mm: number): Formed =>
  ({ kind: 'full', from: 'model', parameters: { size_mm }, sheet: { positions: [0, 0, 0] } }) as never;
const resultOf = ({ from, parameters }: Formed): CraftResult =>
  ({ id: 'r', mesh: from, parameters }) as never;
const product = (output: string, blob: string): Product => ({ outputs: { [output]: { blob } } }) as never;
const print = (blob: string) => product('formed.glb', blob);
const mould = (blob: string) => product('draft.ply', blob);

/** The parts of a session that extras read; a file's bytes are its hash. */
const sessionWith = (first: Formed) => ({
  shown: signal<Formed | null>(first),
  result: signal<CraftResult | null>(resultOf(first)),
  print: signal<Product | null>(null),
  mould: signal<Product | null>(null),
  document: signal({ parameters: {} }),
  activity: signal({ kind: 'idle' }),
  hasColours: signal(false),
  operationNamed: (name: string) => ({ name }),
  services: { projects: { blobs: { read: (hash: string) => Promise.resolve(hash) } } },
});
const watch = (session: ReturnType<typeof sessionWith>) => {
  const watched = watchExtras(session as unknown as ThermoformSession);
  end = watched.dispose;
  return watched.extras;
};
const rest = () => vi.advanceTimersByTimeAsync(1000);
let end = () => {};

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal('createImageBitmap', () => Promise.resolve({}));
});
afterEach(() => {
  end();
  vi.useRealTimers();
  vi.unstubAllGlobals();
  vi.mocked(bytesToSave).mockClear();
  view.value = 'thickness';
});

test('a print made with other settings is not shown as the present one, and the present one is made', async () => {
  view.value = 'texture';
  const session = sessionWith(formed(100));
  session.print.value = print('red');
  const extras = watch(session);
  await rest();
  expect(extras.value.printed).toMatchObject({ file: 'red', uvs: 'red' });

  batch(() => {
    session.document.value = { parameters: { colours: 'blue' } };
    session.print.value = null;
  });
  expect(extras.value.printed).toBeNull();
  await rest();
  expect(vi.mocked(bytesToSave).mock.calls.map(([, operation]) => operation)).toEqual([printing]);
  session.print.value = print('blue');
  await rest();
  expect(extras.value.printed).toMatchObject({ file: 'blue', uvs: 'blue' });
});

test('a view that is chosen waits for nothing', async () => {
  watch(sessionWith(formed(100)));
  await rest();
  expect(bytesToSave).not.toHaveBeenCalled();
  view.value = 'undercut';
  await vi.advanceTimersByTimeAsync(0);
  expect(bytesToSave).toHaveBeenCalledTimes(1);
});

test('of a slider on its way nothing is made; what failed is made again with other settings', async () => {
  view.value = 'texture';
  const session = sessionWith(formed(100));
  session.print.value = print('red');
  watch(session);
  session.print.value = null;
  for (const size of [1, 2, 3]) {
    session.document.value = { parameters: { size } };
    await vi.advanceTimersByTimeAsync(100);
  }
  expect(bytesToSave).not.toHaveBeenCalled();
  await rest();
  expect(bytesToSave).toHaveBeenCalledTimes(1);
  session.activity.value = { kind: 'exporting' };
  session.activity.value = { kind: 'idle' };
  await rest();
  expect(bytesToSave).toHaveBeenCalledTimes(1);
  session.document.value = { parameters: { size: 4 } };
  await rest();
  expect(bytesToSave).toHaveBeenCalledTimes(2);
});

test('another result has its own draft, read once it is shown', async () => {
  view.value = 'undercut';
  const [first, second] = [formed(100), formed(50)];
  const session = sessionWith(first);
  session.mould.value = mould('first');
  const extras = watch(session);
  await rest();
  expect(extras.value.draft).toMatchObject({ of: first, mesh: { positions: 'first' } });

  // Chosen, but not read yet.
  batch(() => {
    session.result.value = resultOf(second);
    session.mould.value = mould('second');
  });
  await rest();
  expect(extras.value.draft).toBeNull();
  session.shown.value = second;
  await rest();
  expect(extras.value.draft).toMatchObject({ of: second, mesh: { positions: 'second' } });

  // Nobody has made a draft of the third.
  const third = formed(25);
  batch(() => {
    session.result.value = resultOf(third);
    session.mould.value = null;
    session.shown.value = third;
  });
  expect(extras.value.draft).toBeNull();
  await rest();
  expect(vi.mocked(bytesToSave).mock.calls.map(([, operation]) => operation)).toEqual([moulding]);
});

test('what was read too late is not shown', async () => {
  view.value = 'undercut';
  const [first, second] = [formed(100), formed(50)];
  const session = sessionWith(first);
  let read: (bytes: string) => void = () => {};
  session.services.projects.blobs.read = () => new Promise((resolve) => (read = resolve));
  session.mould.value = mould('first');
  const extras = watch(session);
  const late = read;
  batch(() => {
    session.result.value = resultOf(second);
    session.shown.value = second;
    session.mould.value = null;
  });
  late('first');
  await rest();
  expect(extras.value.draft).toBeNull();
});

test('a preview of a coloured model is shown in its colours, one without colours is not', async () => {
  view.value = 'texture';
  const first = { ...formed(100), kind: 'preview' } as Formed;
  const session = sessionWith(first);
  session.result.value = null;
  const extras = watch(session);
  await rest();
  expect(extras.value.printed).toBeNull();
  expect(vi.mocked(previewPrint)).not.toHaveBeenCalled();

  session.hasColours.value = true;
  await rest();
  expect(extras.value.printed).toMatchObject({ of: first, uvs: 'own', url: null });
  session.shown.value = { ...formed(90), kind: 'preview' } as Formed;
  expect(extras.value.printed).toBeNull(); // another sheet
  await rest();
  expect(extras.value.printed).toMatchObject({ of: session.shown.value, uvs: 'own' });
  expect(vi.mocked(previewPrint)).toHaveBeenCalledTimes(2);
});
