// SPDX-License-Identifier: GPL-3.0-or-later
// The native backend against a small server that speaks docs/job_contract.md.
// @vitest-environment node
import { createServer } from 'node:http';
import type { IncomingMessage, Server, ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { WebSocket as ServerSocket } from 'ws';
import { WebSocket as NodeSocket, WebSocketServer } from 'ws';
import { leaving } from './backend';
import type { Job } from './contract';
import type { NativeBackendOptions } from './native_backend';
import { NativeBackend } from './native_backend';
import type { ConnectionState } from './native_connection';
import { takeToken, tokenIn } from './native_connection';

const hash = 'ab'.repeat(32);
const job: Job = {
  operation: 'relief',
  parameters: {},
  inputs: { mesh: { sha256: hash, file_name: 'a.obj' } },
};
const status = {
  version: '1',
  cores: 2,
  memory_mb: 1,
  jobs_running: 0,
  jobs_queued: 0,
  upload_limit_bytes: 9,
  triangle_limit: 9,
};

class FakeServer {
  readonly blobs = new Map<string, Buffer>();
  readonly jobs = new Map<string, Record<string, unknown>>();
  readonly sockets = new Set<ServerSocket>();
  readonly requests: string[] = [];
  cancelledIds: string[] = [];
  full = false;
  token = 'secret';
  #server: Server = createServer((request, response) => void this.#answer(request, response));
  #sockets = new WebSocketServer({ noServer: true });

  async listen(port = 0): Promise<number> {
    this.#server.on('upgrade', (request, socket, head) => {
      const protocols = request.headers['sec-websocket-protocol'] ?? '';
      if (!protocols.includes('formwright.v1') || !protocols.includes('token.secret'))
        return socket.destroy();
      return this.#sockets.handleUpgrade(request, socket, head, (ws) => {
        this.sockets.add(ws);
        ws.on('close', () => this.sockets.delete(ws));
        ws.on('message', (text) => {
          const message = JSON.parse(String(text)) as { type: string; id: string };
          if (message.type === 'cancel') this.cancelledIds.push(message.id);
        });
      });
    });
    await new Promise<void>((resolve) => this.#server.listen(port, '127.0.0.1', resolve));
    return (this.#server.address() as AddressInfo).port;
  }
  say(message: object): void {
    for (const socket of this.sockets) socket.send(JSON.stringify(message));
  }
  drop(): void {
    for (const socket of this.sockets) socket.terminate();
  }
  finish(id: string): void {
    const outputs = { 'relief.ply': { media_type: 'application/x-ply', bytes: 2 } };
    this.jobs.set(id, { id, state: 'done', result: { report: { vertices: 5 }, outputs } });
  }
  async close(): Promise<void> {
    this.drop();
    this.#server.closeAllConnections();
    await new Promise((resolve) => this.#server.close(resolve));
  }

  async #answer(request: IncomingMessage, response: ServerResponse): Promise<void> {
    const path = (request.url ?? '').replace('/api/', '');
    this.requests.push(`${request.method} ${path}`);
    const send = (code: number, body: unknown = {}) => {
      response.writeHead(code, { 'Content-Type': 'application/json' });
      response.end(JSON.stringify(body));
    };
    if (request.headers.authorization !== `Bearer ${this.token}`)
      return send(401, { error: { code: 'invalid_input', where: 'token', message: 'The token is wrong.' } });
    if (path === 'status') return send(200, status);
    const [kind, id = '', part] = path.split('/');
    if (kind === 'blobs') {
      const chunks: Buffer[] = [];
      for await (const chunk of request) chunks.push(chunk as Buffer);
      this.blobs.set(id, Buffer.concat(chunks));
      return send(201);
    }
    if (request.method === 'POST' && id === '') {
      if (this.full) return send(429);
      const made = `job${this.jobs.size}`;
      this.jobs.set(made, { id: made, state: 'running' });
      return send(202, { id: made });
    }
    if (part === 'outputs') return void response.end(Buffer.from([7, 8]));
    if (part === 'cancel') {
      this.cancelledIds.push(id);
      return send(202);
    }
    const record = this.jobs.get(id);
    return record
      ? send(200, record)
      : send(404, { error: { code: 'invalid_input', where: 'id', message: 'No such job.' } });
  }
}

let server: FakeServer;
let port: number;
let states: ConnectionState[];
let native: NativeBackend;
const read = vi.fn(() => Promise.resolve(new Uint8Array([1, 2, 3])));
const wait = (condition: () => boolean) =>
  vi.waitFor(() => expect(condition()).toBe(true), { timeout: 5000, interval: 5 });
const connect = (token = 'secret', more: Partial<NativeBackendOptions> = {}) =>
  new NativeBackend({
    origin: `http://127.0.0.1:${port}`,
    token,
    blobs: { read },
    onState: (state) => states.push(state),
    WebSocket: NodeSocket as unknown as typeof WebSocket,
    pace: 0.02,
    ...more,
  });

beforeEach(async () => {
  server = new FakeServer();
  port = await server.listen();
  states = [];
  read.mockClear();
  native = connect();
  await wait(() => states.at(-1)?.state === 'ready');
});
afterEach(async () => {
  native.dispose();
  await server.close();
});

describe('NativeBackend', () => {
  it('sends the blob, runs, reports progress, reads outputs', async () => {
    const fractions: number[] = [];
    const accepted = vi.fn();
    const running = native.run(job, {
      onProgress: ({ fraction }) => fractions.push(fraction),
      onAccepted: accepted,
    });
    await wait(() => server.jobs.has('job0') && server.requests.includes('GET jobs/job0'));
    expect(server.blobs.get(hash)).toEqual(Buffer.from([1, 2, 3]));
    server.say({ type: 'progress', id: 'job0', fraction: 0.5, stage: 'x', seconds_left: 1 });
    await wait(() => fractions.length === 1);
    server.finish('job0');
    server.say({ type: 'finished', id: 'job0', state: 'done' });
    const result = await running;
    expect(accepted).toHaveBeenCalledWith('job0');
    expect(result.report).toEqual({ vertices: 5 });
    expect(await result.outputs.get('relief.ply')?.read()).toEqual(new Uint8Array([7, 8]));
    server.finish('job1');
    void native.run(job).catch(() => undefined);
    await wait(() => server.jobs.size === 3);
    expect(read).toHaveBeenCalledTimes(1);
  });

  it('finds a finished job again after the line broke', async () => {
    const running = native.run(job);
    await wait(() => server.requests.includes('GET jobs/job0'));
    server.finish('job0');
    server.drop(); // the news of its end is lost with the line
    expect((await running).report).toEqual({ vertices: 5 });
    expect(states.map(({ state }) => state)).toContain('lost');
  });

  it('finds a job of an earlier page', async () => {
    server.finish('old');
    expect((await native.resume('old')).report).toEqual({ vertices: 5 });
    await expect(native.resume('gone')).rejects.toMatchObject({ where: 'id' });
  });

  it('cancels over the socket and answers at once', async () => {
    const abort = new AbortController();
    const running = native.run(job, { signal: abort.signal });
    await wait(() => server.requests.includes('GET jobs/job0'));
    abort.abort();
    await expect(running).rejects.toMatchObject({ code: 'cancelled' });
    await wait(() => server.cancelledIds.includes('job0'));
  });

  it('leaves a job to itself where the page turned to something else', async () => {
    const abort = new AbortController();
    const running = native.run(job, { signal: abort.signal });
    await wait(() => server.requests.includes('GET jobs/job0'));
    abort.abort(leaving);
    await expect(running).rejects.toMatchObject({ code: 'cancelled' });
    const ended = new AbortController();
    const another = native.run(job, { signal: ended.signal }).catch(() => undefined);
    await wait(() => server.requests.includes('GET jobs/job1'));
    ended.abort(); // by the same line, so that a word about the first one would have come before
    await another;
    await wait(() => server.cancelledIds.length > 0);
    expect(server.cancelledIds).toEqual(['job1']);
  });

  it('ends a job that was left before anyone was told its name', async () => {
    const abort = new AbortController();
    const accepted = vi.fn();
    const tooLate: typeof fetch = async (input, init) => {
      const answer = await fetch(input, { ...init, signal: null });
      if (init?.method === 'POST' && String(input).endsWith('/jobs')) abort.abort(leaving);
      return answer;
    };
    const other = connect('secret', { fetch: tooLate });
    await wait(() => states.filter(({ state }) => state === 'ready').length === 2);
    const running = other.run(job, { signal: abort.signal, onAccepted: accepted });
    await expect(running).rejects.toMatchObject({ code: 'cancelled' });
    await wait(() => server.cancelledIds.includes('job0'));
    expect(accepted).not.toHaveBeenCalled();
    other.dispose();
  });

  it('keeps nobody waiting for a worker that was started again with another token', async () => {
    const running = native.run(job);
    await wait(() => server.requests.includes('GET jobs/job0'));
    server.token = 'new';
    server.drop();
    await expect(running).rejects.toMatchObject({ code: 'unreachable', message: 'The token is wrong.' });
    expect(states.at(-1)).toEqual({ state: 'refused', message: 'The token is wrong.' });
  });

  it('finds no fault in a job that it may not ask about', async () => {
    server.finish('done');
    const { outputs } = await native.resume('done');
    server.token = 'new';
    await expect(native.resume('done')).rejects.toMatchObject({ code: 'unreachable' });
    await expect(outputs.get('relief.ply')?.read()).rejects.toMatchObject({ code: 'unreachable' });
  });

  it('passes on the job’s own error, and says when the queue is full', async () => {
    server.jobs.set('bad', {
      id: 'bad',
      state: 'failed',
      error: { code: 'invalid_input', where: 'thickness_mm', message: 'Too thick.' },
    });
    await expect(native.resume('bad')).rejects.toMatchObject({
      where: 'thickness_mm',
      message: 'Too thick.',
    });
    server.full = true;
    await expect(native.run(job)).rejects.toThrow(/queue is full/);
  });

  it('stops asking when the token is wrong', async () => {
    states = [];
    const stranger = connect('guess');
    await wait(() => states.at(-1)?.state === 'refused');
    stranger.dispose();
  });
});

describe('takeToken', () => {
  it('moves the token from the address into the session', () => {
    const kept = new Map<string, string>();
    const storage = {
      getItem: (key: string) => kept.get(key) ?? null,
      setItem: (key: string, value: string) => void kept.set(key, value),
    };
    const replace = vi.fn();
    const place = { hash: '#token=a%2Bb', pathname: '/', search: '' };
    expect(takeToken(place, storage, replace)).toBe('a+b');
    expect(replace).toHaveBeenCalledWith('/');
    expect(takeToken({ ...place, hash: '#/relief' }, storage, replace)).toBe('a+b');
    expect(replace).toHaveBeenCalledTimes(1);
  });

  it('is not asked twice for the same one: the address has none afterwards', () => {
    const storage = { getItem: () => null, setItem: () => undefined };
    for (const hash of ['#token=a', '#/relief&token=a', '#token=a&/x']) {
      expect(tokenIn(hash)?.[1]).toBe('a');
      const replace = vi.fn();
      takeToken({ hash, pathname: '/', search: '' }, storage, replace);
      expect(tokenIn(new URL(String(replace.mock.calls[0]?.[0]), 'http://a').hash)).toBeNull();
    }
  });
});
