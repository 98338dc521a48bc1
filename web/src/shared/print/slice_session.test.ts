// SPDX-License-Identifier: GPL-3.0-or-later
// @vitest-environment happy-dom
import { signal } from '@preact/signals';
import { h, render } from 'preact';
import { act } from 'preact/test-utils';
import { afterEach, expect, test, vi } from 'vitest';
import { JobError } from '../../jobs/contract';
import { uploadGcode } from '../../machines/printing/worker_tasks';
import { toast } from '../../ui';
import type { Solid } from './print_request';
import type { Services } from '../session/services';
import { SliceDialog } from './slice_dialog';
import { SliceSession } from './slice_session';

vi.mock('../../ui', async (original) => ({ ...(await original<object>()), toast: vi.fn() }));
vi.mock('../../machines/printing/worker_tasks', () => ({
  readMachine: () => Promise.resolve({ name: 'Mini', state: 'ready' }),
  uploadGcode: vi.fn(),
}));

const services = { worker: {}, connection: signal(null) } as unknown as Services;
const solid: Solid = { title: 'the mould', fileName: 'mould.stl', bytes: new Uint8Array() };
const refused = new JobError({ code: 'could_not_solve', where: '', message: 'It is full.' });

/** Sliced, with a printer to send it to. */
function ready(session: SliceSession): SliceSession {
  const facts = { seconds: null, filament_g: null, filament_mm: null };
  session.sliced.value = { profile: '', gcode: new Uint8Array(), facts };
  session.servers.value = [{ id: 'mini', name: 'Mini', kind: 'octoprint', detail: '', state: 'ready' }];
  session.server.value = 'mini';
  return session;
}
const upload = () => {
  let end = { succeed: (_: string) => {}, fail: (_: unknown) => {} };
  vi.mocked(uploadGcode).mockImplementationOnce(
    (...[, , , , , options]) =>
      new Promise((succeed, fail) => {
        end = { succeed, fail };
        options?.signal?.addEventListener('abort', () => fail(new DOMException('aborted', 'AbortError')));
      }),
  );
  return { succeed: (name: string) => end.succeed(name), fail: (error: unknown) => end.fail(error) };
};
afterEach(() => vi.mocked(toast).mockClear());

test('who has closed the dialog is told how the upload ended', async () => {
  const session = ready(new SliceSession(services, solid));
  const first = upload();
  let ended = session.upload(true);
  session.close();
  first.fail(refused);
  await ended;
  expect(vi.mocked(toast).mock.calls).toEqual([['Sending to Mini: It is full.', true]]);
  const second = upload();
  ended = session.upload(true);
  second.succeed('mould.gcode');
  await ended;
  expect(toast).toHaveBeenLastCalledWith('Mini is printing mould.gcode.');
});

test('an open dialog says it itself, and nothing of what was cancelled', async () => {
  const session = ready(new SliceSession(services, solid));
  const first = upload();
  let ended = session.upload(false);
  first.fail(refused);
  await ended;
  expect(session.problem.value).toBe('It is full.');
  upload();
  ended = session.upload(false);
  session.cancel();
  await ended;
  expect(session.problem.value).toBeNull();
  expect(toast).not.toHaveBeenCalled();
});

test('a dialog that opens during an upload shows that one with its Cancel', async () => {
  const session = ready(SliceSession.of(services, solid));
  const sending = upload();
  const ended = session.upload(false);
  session.close();
  const other: Solid = { ...solid, title: 'the relief' };
  expect(SliceSession.of(services, other)).toBe(session);

  const root = document.body.appendChild(document.createElement('div'));
  const dialog = h(SliceDialog, { services, solid: other, onClose: () => undefined });
  await act(() => render(dialog, root));
  expect(root.textContent).toContain('Print the mould in plastic');
  expect(root.textContent).toMatch(/Sending to Mini.*Cancel/);
  await act(() => render(null, root));
  sending.fail(refused);
  await ended;
  expect(toast).toHaveBeenCalledTimes(1);
  expect(SliceSession.of(services, other).solid).toBe(other);
});
