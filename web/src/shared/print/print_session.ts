// SPDX-License-Identifier: GPL-3.0-or-later
// Something on its way to paper at true size: laid out for the paper of a printer that the worker reaches, or of the person's own
// choice, shown before it is printed. A print goes on when its dialog is closed.
import { computed, effect, signal, untracked } from '@preact/signals';
import type { Json, JsonObject, Operation } from '../../jobs/contract';
import { asJobError, findOperation } from '../../jobs/contract';
import { LatestOnly } from '../../jobs/latest_only';
import type { BridgeMachine } from '../../machines/links/bridge_link';
import { listBridgeMachines } from '../../machines/links/bridge_link';
import type { PageLayout, Paper, PaperPrinter } from '../../machines/printing/paper';
import { decidedByPaper, layoutOf, paperParameters, papersToChoose } from '../../machines/printing/paper';
import type { WorkerTask } from '../../machines/printing/worker_tasks';
import { readMachine, runTask } from '../../machines/printing/worker_tasks';
import { toast } from '../../ui';
import { bytesOf } from '../session/import_model';
import type { Printable } from './print_request';
import { sentences } from '../session/report';
import { readyWorker } from '../session/services';
import type { Services } from '../session/services';

interface Laid {
  readonly layout: PageLayout | null;
  readonly pdf: Uint8Array<ArrayBuffer>;
  readonly notes: readonly string[];
  readonly key: string;
}

const pagesOperation = 'page-tiles';
/** Without a printer the pages become a file. */
export const asFile = '';

export class PrintSession {
  readonly services: Services;
  readonly printable: Printable;
  readonly operation: Operation | null;
  readonly printers = signal<readonly BridgeMachine[]>([]);
  readonly looking = signal(true);
  readonly chosen = signal(asFile);
  readonly printer = signal<PaperPrinter | null>(null);
  readonly paperName = signal('');
  readonly parameters = signal<JsonObject>({});
  readonly copies = signal(1);
  readonly quality = signal('normal');
  readonly laid = signal<Laid | null>(null);
  readonly fieldErrors = signal<Readonly<Record<string, string>>>({});
  readonly problem = signal<string | null>(null);
  readonly task = signal<WorkerTask | null>(null);
  readonly done = signal<string | null>(null);
  #abort: AbortController | null = null;
  #open = true;
  #blob: Promise<string> | null = null;
  readonly #stop: () => void;

  readonly papers = computed<Paper[]>(() => papersToChoose(this.printer.value?.media ?? []));
  readonly paper = computed<Paper | null>(
    () => this.papers.value.find(({ name }) => name === this.paperName.value) ?? this.papers.value[0] ?? null,
  );
  readonly asked = computed<JsonObject>(() => ({
    ...this.parameters.value,
    ...(this.chosen.value !== asFile && this.paper.value ? paperParameters(this.paper.value) : {}),
  }));
  readonly isCurrent = computed(() => this.laid.value?.key === JSON.stringify(this.asked.value));
  readonly #latest = new LatestOnly<JsonObject>((parameters, abort) => this.#lay(parameters, abort));

  constructor(services: Services, printable: Printable) {
    this.services = services;
    this.printable = printable;
    const { catalog } = services;
    const operation = catalog.value && findOperation(catalog.value, pagesOperation);
    this.operation = operation ?? null;
    void this.#lookForPrinters();
    this.#stop = effect(() => {
      const asked = this.asked.value;
      const waits = this.chosen.value !== asFile && this.paper.value === null;
      untracked(() => {
        if (!waits && !this.isCurrent.value) this.#latest.request(asked);
      });
    });
  }

  /** Laid out by whoever made it. */
  get isPages(): boolean {
    return this.printable.fileName.endsWith('.pdf');
  }

  /** The parameters that are the person's: a printer's paper decides the others. */
  get ownOperation(): Operation | null {
    if (this.operation === null || this.isPages) return null;
    const { properties } = this.operation.parameters;
    const hidden = this.chosen.value === asFile ? [] : decidedByPaper;
    const own = Object.fromEntries(Object.entries(properties).filter(([name]) => !hidden.includes(name)));
    return { ...this.operation, parameters: { properties: own } };
  }

  setParameter(name: string, value: Json): void {
    this.parameters.value = { ...this.parameters.value, [name]: value };
  }

  value(name: string): Json {
    return this.asked.value[name] ?? this.operation?.parameters.properties[name]?.default ?? null;
  }

  async choose(id: string): Promise<void> {
    this.chosen.value = id;
    this.printer.value = null;
    this.problem.value = null;
    const { worker } = this.services;
    if (id === asFile || worker === null) return;
    try {
      const printer = await readMachine<PaperPrinter>(worker, id);
      if (this.chosen.value !== id) return;
      this.printer.value = printer;
      if (!printer.qualities.includes(this.quality.value))
        this.quality.value = printer.qualities[0] ?? 'normal';
      if (this.papers.value.length === 0)
        this.problem.value = `${printer.name} does not report which paper is loaded: check its trays.`;
    } catch (thrown) {
      if (this.chosen.value === id) this.problem.value = asJobError(thrown).message;
    }
  }

  async print(): Promise<void> {
    const { worker } = this.services;
    const { printer, paper, laid } = this;
    if (worker === null || printer.value === null || laid.value === null || this.task.value !== null) return;
    const { name } = printer.value;
    const abort = (this.#abort = new AbortController());
    this.problem.value = this.done.value = null;
    this.task.value = { id: '', state: 'sending', sentence: `Sending to ${name}.`, fraction: 0 };
    const wishes = {
      ...(this.isPages || paper.value === null ? {} : { media: paper.value.name }),
      copies: this.copies.value,
      quality: this.quality.value,
      title: this.printable.title,
    };
    try {
      const onTask = (task: WorkerTask) => (this.task.value = task);
      const result = await runTask(worker, this.chosen.value, 'print', laid.value.pdf, wishes, {
        signal: abort.signal,
        onTask,
      });
      this.done.value = [`${name} has printed ${this.printable.title}.`, ...sentences(result, 'notes')].join(
        ' ',
      );
      if (!this.#open) toast(this.done.value);
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code !== 'cancelled') {
        this.problem.value = error.message;
        if (!this.#open) toast(`${this.printable.title} was not printed: ${error.message}`, true);
      } else this.done.value = 'Cancelled: the printer received the cancel command.';
    } finally {
      this.task.value = null;
    }
  }

  cancelPrint(): void {
    this.#abort?.abort();
  }

  /** The dialog is gone; what prints goes on. */
  close(): void {
    this.#open = false;
    this.#latest.cancel();
    this.#stop();
  }

  async #lookForPrinters(): Promise<void> {
    const { worker, connection } = this.services;
    try {
      if (worker === null || connection.value?.state !== 'ready') return;
      const machines = await listBridgeMachines(worker);
      this.printers.value = machines.filter(({ kind }) => kind === 'printer');
      const first = this.printers.value.find(({ state }) => state !== 'off') ?? this.printers.value[0];
      if (first && this.chosen.value === asFile) await this.choose(first.id);
    } catch (thrown) {
      this.problem.value = asJobError(thrown).message;
    } finally {
      this.looking.value = false;
    }
  }

  async #lay(parameters: JsonObject, signal: AbortSignal): Promise<void> {
    const key = JSON.stringify(parameters);
    const { bytes, fileName } = this.printable;
    if (this.isPages) {
      this.laid.value = { layout: null, pdf: bytes, notes: [], key };
      return;
    }
    const backend = readyWorker(this.services) ?? this.services.browser;
    try {
      this.#blob ??= this.services.projects.blobs.hold(bytes);
      const inputs = { drawing: { sha256: await this.#blob, file_name: fileName } };
      const done = await backend.run(
        { operation: pagesOperation, parameters, inputs, outputs: ['pages.pdf'] },
        { signal },
      );
      const pdf = await bytesOf(done, 'pages.pdf');
      this.laid.value = { layout: layoutOf(done.report), pdf, notes: sentences(done.report, 'notes'), key };
      this.fieldErrors.value = {};
      this.problem.value = null;
    } catch (thrown) {
      const error = asJobError(thrown);
      if (error.code === 'cancelled') return;
      if (this.operation?.parameters.properties[error.where])
        this.fieldErrors.value = { [error.where]: error.message };
      else this.problem.value = error.message;
    }
  }
}
