// SPDX-License-Identifier: GPL-3.0-or-later
// Thermoforming's part of a project: formed sheets as results, and what was made of them: prints, moulds.
import type { Catalog, JsonObject, Operation } from '../../jobs/contract';
import { findOperation } from '../../jobs/contract';
import type { CraftDocument, CraftResult, Subject } from '../common/craft_document';
import { CraftCommands, emptyCraft, known, sameRequest, withResult } from '../common/craft_document';

/** A print or a mould: what an operation made of the model, with the parameters it knows. */
export interface Product extends CraftResult {
  readonly operation: string;
}

export interface ThermoformDocument extends CraftDocument {
  /** Newest first. */
  readonly products: readonly Product[];
}

export const simulate = 'thermoform-simulate';
/** Of what is made of a formed sheet; a build offers those that its catalog names. */
export const printing = 'thermoform-texture';
export const moulding = 'thermoform-mould';

export const thermoform = new CraftCommands<ThermoformDocument>('thermoform', {
  ...emptyCraft,
  products: [],
});

/** The simulation with the parameters of everything that is made of its result. */
export function offered(catalog: Catalog): Operation | null {
  const operation = findOperation(catalog, simulate);
  if (operation === undefined) return null;
  const further = [printing, moulding].map((name) => findOperation(catalog, name)?.parameters.properties);
  const properties = Object.assign(
    {},
    ...further,
    operation.parameters.properties,
  ) as typeof operation.parameters.properties;
  // The simulation's own come first, as they are met.
  const ordered = { ...operation.parameters.properties, ...properties };
  return { ...operation, parameters: { properties: ordered } };
}

/** The sheet formed with exactly these parameters over the subject, if there is one. */
export function formedSheet(
  { results }: ThermoformDocument,
  subject: Subject | null,
  parameters: JsonObject,
): CraftResult | null {
  if (subject === null) return null;
  const request = { mesh: subject.key, parameters };
  return results.find((result) => sameRequest(result, request)) ?? null;
}

export function productOf(
  { products, parameters }: ThermoformDocument,
  subject: Subject | null,
  operation: Operation | undefined,
): Product | null {
  if (subject === null || operation === undefined) return null;
  const request = { mesh: subject.key, parameters: known(operation, parameters) };
  return (
    products.find((product) => product.operation === operation.name && sameRequest(product, request)) ?? null
  );
}

/** What was made before of the same with other outputs is kept beside. */
export const addProduct = (made: Product) =>
  thermoform.command({ label: 'Make', recorded: false }, ({ products }) => {
    const same = (old: Product) => old.operation === made.operation && sameRequest(old, made);
    const before = products.find(same);
    const whole = before ? { ...made, outputs: { ...before.outputs, ...made.outputs } } : made;
    const [ours, others] = [true, false].map((own) =>
      products.filter((old) => (old.operation === made.operation) === own),
    );
    return { products: [...withResult(ours ?? [], whole), ...(others ?? [])] };
  });
