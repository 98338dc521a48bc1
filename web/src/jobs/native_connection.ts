// SPDX-License-Identifier: GPL-3.0-or-later
// The line to the native worker: the token from the address, HTTP with it, and a WebSocket that comes
// back by itself.
import type { ErrorMessage, Progress } from './contract';
import { JobError } from './contract';

export interface WorkerStatus {
  readonly version: string;
  readonly cores: number;
  readonly memory_mb: number;
  readonly jobs_running: number;
  readonly jobs_queued: number;
  readonly upload_limit_bytes: number;
  readonly triangle_limit: number;
}

export type ConnectionState =
  | { readonly state: 'connecting' }
  | { readonly state: 'ready'; readonly status: WorkerStatus }
  | { readonly state: 'lost'; readonly retry_in_s: number }
  | { readonly state: 'refused'; readonly message: string };

export type SocketMessage =
  | ({ readonly type: 'progress'; readonly id: string } & (Progress | { readonly progress: Progress }))
  | { readonly type: 'finished'; readonly id: string; readonly state: string };

const tokenKey = 'formwright.token';

/** The part of an address's fragment that holds a token, and the token. */
export const tokenIn = (hash: string) => /(?:^#|&)token=([^&]+)/.exec(hash);

/** Takes `#token=…` out of the address into the session, so that it is neither shared nor bookmarked. */
export function takeToken(
  place: Pick<Location, 'hash' | 'pathname' | 'search'>,
  storage: Pick<Storage, 'getItem' | 'setItem'>,
  replaceAddress: (url: string) => void,
): string | null {
  const found = tokenIn(place.hash);
  if (found?.[1] !== undefined) {
    storage.setItem(tokenKey, decodeURIComponent(found[1]));
    const rest = place.hash.replace(found[0].replace(/^#/, ''), '').replace(/^#&?$/, '');
    replaceAddress(place.pathname + place.search + rest);
  }
  return storage.getItem(tokenKey);
}

const shortestRetry_s = 0.5;
const longestRetry_s = 15;

export interface ConnectionOptions {
  /** Origin of the worker, such as http://127.0.0.1:8717. */
  readonly origin: string;
  readonly token: string;
  readonly onState: (state: ConnectionState) => void;
  readonly onMessage: (message: SocketMessage) => void;
  readonly fetch?: typeof fetch;
  readonly WebSocket?: typeof WebSocket;
  /** Multiplies the waiting times; for tests. */
  readonly pace?: number;
}

export class NativeConnection {
  readonly #options: ConnectionOptions;
  #socket: WebSocket | null = null;
  #retry_s = shortestRetry_s;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #closed = false;

  constructor(options: ConnectionOptions) {
    this.#options = options;
  }

  connect(): void {
    void this.#open();
  }

  close(): void {
    this.#closed = true;
    clearTimeout(this.#timer);
    this.#socket?.close();
  }

  send(message: object): boolean {
    if (this.#socket?.readyState !== 1) return false;
    this.#socket.send(JSON.stringify(message));
    return true;
  }

  /** One request under /api. Throws JobError: the worker's own, or `unreachable`. */
  async request(path: string, init: RequestInit = {}): Promise<Response> {
    const headers = new Headers(init.headers);
    headers.set('Authorization', `Bearer ${this.#options.token}`);
    let response: Response;
    try {
      const send = this.#options.fetch ?? fetch;
      response = await send(`${this.#options.origin}/api/${path}`, { ...init, headers });
    } catch (thrown) {
      if (init.signal?.aborted) throw thrown;
      const message = 'The worker program does not answer; start it again with “formwright serve”.';
      throw new JobError({ code: 'unreachable', where: '', message });
    }
    return response;
  }

  /** As `request`, for answers that must be a success. */
  async requestOk(path: string, init: RequestInit = {}): Promise<Response> {
    const response = await this.request(path, init);
    if (!response.ok) throw new JobError(await errorOf(response));
    return response;
  }

  async json<T>(path: string, init: RequestInit = {}): Promise<T> {
    return (await (await this.requestOk(path, init)).json()) as T;
  }

  /** A line of its own beside the one for jobs, such as a machine's. */
  socket(path: string, protocol: string): WebSocket {
    const { origin, token } = this.#options;
    const Socket = this.#options.WebSocket ?? WebSocket;
    return new Socket(`${origin.replace(/^http/, 'ws')}/api/${path}`, [protocol, `token.${token}`]);
  }

  async status(): Promise<WorkerStatus> {
    return await this.json<WorkerStatus>('status');
  }

  async #open(): Promise<void> {
    const { onState } = this.#options;
    onState({ state: 'connecting' });
    let status: WorkerStatus;
    try {
      status = await this.status();
    } catch (thrown) {
      if (this.#closed) return;
      if (thrown instanceof JobError && (thrown.code !== 'unreachable' || isRefusal(thrown))) {
        onState({ state: 'refused', message: thrown.message });
        return;
      }
      this.#retry();
      return;
    }
    if (this.#closed) return;
    const socket = this.socket('socket', 'formwright.v1');
    this.#socket = socket;
    socket.onopen = () => {
      this.#retry_s = shortestRetry_s;
      onState({ state: 'ready', status });
    };
    socket.onmessage = (event: MessageEvent<string>) =>
      this.#options.onMessage(JSON.parse(event.data) as SocketMessage);
    socket.onclose = () => {
      this.#socket = null;
      if (!this.#closed) this.#retry();
    };
  }

  #retry(): void {
    this.#options.onState({ state: 'lost', retry_in_s: this.#retry_s });
    this.#timer = setTimeout(() => void this.#open(), this.#retry_s * 1000 * (this.#options.pace ?? 1));
    this.#retry_s = Math.min(longestRetry_s, this.#retry_s * 2);
  }
}

/** The worker answers, but not to this page: it was started again, with another token. */
export const isRefusal = ({ code, where }: JobError): boolean => code === 'unreachable' && where === 'token';

async function errorOf(response: Response): Promise<ErrorMessage> {
  // No fault of the job: whoever has the token finds it again.
  const refusal = response.status === 401 ? ({ code: 'unreachable', where: 'token' } as const) : {};
  try {
    const body = (await response.json()) as { error?: ErrorMessage };
    if (body.error?.message) return { ...body.error, ...refusal };
  } catch {
    // Not JSON: said from the status below.
  }
  if (response.status === 401 || response.status === 403)
    return {
      code: 'invalid_input',
      where: 'token',
      message: 'The worker did not accept this page; open the address it printed when it started.',
      ...refusal,
    };
  if (response.status === 413)
    return { code: 'invalid_input', where: 'mesh', message: 'The model is larger than the worker accepts.' };
  if (response.status === 429)
    return {
      code: 'could_not_solve',
      where: '',
      message: 'The worker’s queue is full; try again when a job has ended.',
    };
  return { code: 'internal', where: '', message: `The worker answered with status ${response.status}.` };
}
