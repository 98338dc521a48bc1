// SPDX-License-Identifier: GPL-3.0-or-later
// What further operations make of a full result: prints, moulds, plans.
import type { Catalog, JobInput, JsonObject, Operation } from '../../jobs/contract';
import { findOperation, JobError } from '../../jobs/contract';
import type { BlobReference } from '../../project/document';
import type { CraftResult, RoomCommands, RoomDocument } from './craft_document';
import { known, sameRequest, withResult } from './craft_document';
import { bytesOf } from './import_model';
import type { RoomSession } from './room_session';
import { readyWorker } from './services';

/** Made by an operation, with the parameters it knows; `mesh` names what it was made from. */
export interface Product extends CraftResult {
  readonly operation: string;
}

export interface RoomWithProducts extends RoomDocument {
  /** Newest first. */
  readonly products: readonly Product[];
}

/** An operation with the parameters and presets of those that go on from its result. */
export function offeredTogether(
  catalog: Catalog,
  first: string,
  further: readonly string[],
): Operation | null {
  const operation = findOperation(catalog, first);
  if (operation === undefined) return null;
  const all = [operation, ...further.flatMap((name) => findOperation(catalog, name) ?? [])];
  const others = all.map(({ parameters }) => parameters.properties);
  const own = operation.parameters.properties;
  // Where both know a parameter the first one's declaration counts; its own come first, as they are met.
  const properties = Object.assign({ ...own }, ...others, own) as typeof own;
  const presets = all.flatMap((one) => one.presets ?? []);
  const named = new Map(presets.map((list) => [list.name, list]));
  return { ...operation, parameters: { properties }, presets: [...named.values()] };
}

export function productOf(
  { products, parameters }: Pick<RoomWithProducts, 'products' | 'parameters'>,
  from: string | null,
  operation: Operation | undefined,
): Product | null {
  if (from === null || operation === undefined) return null;
  const request = { mesh: from, parameters: known(operation, parameters) };
  const own = (product: Product) => product.operation === operation.name && sameRequest(product, request);
  return products.find(own) ?? null;
}

/** What was made before of the same with other outputs is kept beside. */
export const addProduct = <D extends RoomWithProducts>(commands: RoomCommands<D>, made: Product) =>
  commands.command({ label: 'Make', recorded: false }, ({ products }) => {
    const same = (old: Product) => old.operation === made.operation && sameRequest(old, made);
    const before = products.find(same);
    const whole = before ? { ...made, outputs: { ...before.outputs, ...made.outputs } } : made;
    const [ours, others] = [true, false].map((own) =>
      products.filter((old) => (old.operation === made.operation) === own),
    );
    const kept: Partial<RoomWithProducts> = {
      products: [...withResult(ours ?? [], whole), ...(others ?? [])],
    };
    return kept as Partial<D>;
  });

export interface ProductRequest {
  readonly operation: Operation;
  /** Names what the inputs are. */
  readonly from: string;
  readonly inputs: Readonly<Record<string, JobInput>>;
  readonly output: string;
  /** Shown beside what is saved, and so of the same run. */
  readonly beside: readonly string[];
  /** In words. */
  readonly label: string;
  /** Those in force, where they are other ones than the room's document has. */
  readonly parameters?: JsonObject;
}

/** The bytes of an output, made where nobody has. Null: failed or cancelled, which the page has said. */
export async function productBytes<D extends RoomWithProducts>(
  session: RoomSession<D>,
  { operation, from, inputs, output, beside, label, parameters: inForce }: ProductRequest,
): Promise<Uint8Array<ArrayBuffer> | null> {
  const { projects } = session.services;
  const { products, parameters: own } = session.document.value;
  const asked = inForce ?? own;
  const kept = productOf({ products, parameters: asked }, from, operation)?.outputs[output];
  if (kept && (await projects.blobs.has(kept.blob))) return await projects.blobs.read(kept.blob);
  const declared = operation.outputs.map(({ name }) => name);
  const outputs = [...new Set([output, ...beside])].filter((name) => declared.includes(name));
  return await session.busy(
    'exporting',
    label,
    async (options) => {
      const backend = readyWorker(session.services) ?? session.services.browser;
      const parameters = known(operation, asked);
      const start = performance.now();
      const done = await backend.run({ operation: operation.name, parameters, inputs, outputs }, options);
      const made: Record<string, BlobReference> = {};
      for (const name of outputs) {
        const mediaType = done.outputs.get(name)?.mediaType;
        if (mediaType) made[name] = await session.keep(await bytesOf(done, name), mediaType);
      }
      const own = made[output];
      if (own === undefined)
        throw new JobError({
          code: 'internal',
          where: output,
          message: `The solver did not make the file ${output}.`,
        });
      options.do(
        addProduct(session.commands, {
          id: crypto.randomUUID(),
          operation: operation.name,
          made_unix_s: Math.round(Date.now() / 1000),
          backend: backend.kind,
          seconds: (performance.now() - start) / 1000,
          mesh: from,
          parameters,
          report: done.report,
          outputs: made,
        }),
      );
      return await projects.blobs.read(own.blob);
    },
    (error) => session.report(error, `Could not make the ${label}`),
  );
}
