// SPDX-License-Identifier: GPL-3.0-or-later
import { describe, expect, it } from 'vitest';
import type { Catalog, Operation, ParameterSchema } from '../../jobs/contract';
import type { ProjectDocument } from '../../project/document';
import { newDocument } from '../../project/document';
import type { CraftModel, CraftResult } from '../../shared/session/craft_document';
import { CraftCommands, emptyCraft, inForce, known, subjectOf } from '../../shared/session/craft_document';
import { machineProfile, profileInputs, withProfile } from '../../shared/session/machine_profile';
import type { Product } from '../../shared/session/products';
import { addProduct, productOf } from '../../shared/session/products';
import { formedSheet, hasMaterials, offered, printing, simulate, thermoform } from './thermoform_document';

const number = (value: number): ParameterSchema => ({ type: 'number', default: value });
const operation = (name: string, properties: Record<string, ParameterSchema>): Operation => ({
  name,
  title: name,
  inputs: [],
  parameters: { properties },
  outputs: [],
});
const forming = operation(simulate, { size_mm: number(100), vacuum_kpa: number(80) });
const print = operation(printing, {
  size_mm: number(100),
  vacuum_kpa: number(80),
  dots_per_inch: number(300),
});
const catalog: Catalog = { version: '', operations: [forming, print], samples: [], mesh_formats: [] };
const all = offered(catalog) as Operation;

const blob = (digit: string) => ({ blob: digit.repeat(64), bytes: 1, media_type: 'x' });
const model: CraftModel = {
  source: { kind: 'sample', sample: 'cat', title: 'Cat' },
  mesh: blob('a'),
  preview: blob('b'),
  report: {},
};
const subject = subjectOf(model.mesh, 'mould', {});
const result = (id: string, parameters: Record<string, number>): CraftResult => ({
  id,
  made_unix_s: 0,
  backend: 'wasm',
  seconds: 1,
  mesh: model.mesh.blob,
  parameters,
  report: {},
  outputs: { 'sheet.ply': blob('c') },
});
const product = (id: string, parameters: Record<string, number>, output: string): Product => ({
  ...result(id, parameters),
  operation: printing,
  outputs: { [output]: blob('d') },
});
const opened = (): ProjectDocument =>
  thermoform.openModel(all, model, 'Open', {}, () => false).apply(newDocument('1', 'One', 0));

describe('the thermoform in a project', () => {
  it('offers what the build can make, the simulation first', () => {
    expect(Object.keys(all.parameters.properties)).toEqual(['size_mm', 'vacuum_kpa', 'dots_per_inch']);
    expect(offered({ ...catalog, operations: [print] })).toBeNull();
    const alone = offered({ ...catalog, operations: [forming] });
    expect(Object.keys(alone?.parameters.properties ?? {})).toEqual(['size_mm', 'vacuum_kpa']);
  });

  it('finds a sheet by what forming depends on, whatever the print is like', () => {
    let document = thermoform.addResult(result('r', { vacuum_kpa: 60 })).apply(opened());
    document = thermoform.setParameters(all, { vacuum_kpa: 60, dots_per_inch: 150 }, 'Set').apply(document);
    const craft = thermoform.of(document);
    expect(craft.parameters).toEqual({ vacuum_kpa: 60, dots_per_inch: 150 });
    expect(formedSheet(craft, subject, known(forming, craft.parameters))?.id).toBe('r');
    expect(formedSheet(craft, subject, { vacuum_kpa: 61 })).toBeNull();
  });

  it('takes a sheet formed with a machine profile for another than one formed without', () => {
    const profile = { name: 'Mine', from: 'lamp', file: blob('e') };
    const with_profile = subjectOf(model.mesh, 'mould', profileInputs(profile));
    expect(with_profile.inputs['profile']).toEqual({ sha256: 'e'.repeat(64), file_name: 'profile.json' });
    const document = thermoform.addResult(result('r', {})).apply(opened());
    expect(formedSheet(thermoform.of(document), subject, {})?.id).toBe('r');
    expect(formedSheet(thermoform.of(document), with_profile, {})).toBeNull();
    const used = machineProfile.use(profile).apply(document);
    expect(machineProfile.of(used).profile).toEqual(profile);
    expect(machineProfile.of(machineProfile.remove().apply(used)).profile).toBeNull();
  });

  it('asks for a default that the machine profile has another value for, and not for the profile’s own', () => {
    const takes = { ...all, inputs: [{ name: 'profile', label: 'Machine profile' }] };
    const profile = { name: 'Mine', from: '', file: blob('e'), parameters: { vacuum_kpa: 71, slip: 2 } };
    const ours = withProfile(takes, profile);
    expect(inForce(ours, {}, 'vacuum_kpa')).toBe(71);
    expect(inForce(ours, {}, 'size_mm')).toBe(100);
    expect(Object.keys(ours.parameters.properties)).toEqual(Object.keys(all.parameters.properties));
    const asked = (vacuum_kpa: number) =>
      thermoform.of(thermoform.setParameters(ours, { vacuum_kpa }, 'Set').apply(opened())).parameters;
    expect(asked(80)).toEqual({ vacuum_kpa: 80 });
    expect(asked(71)).toEqual({});
    expect(withProfile(all, profile)).toBe(all);
    expect(withProfile(takes, null)).toBe(takes);
  });

  it('goes back to an earlier sheet and leaves the print as it is set', () => {
    let document = thermoform.setParameters(all, { size_mm: 50, dots_per_inch: 150 }, 'Set').apply(opened());
    const old = result('r', { vacuum_kpa: 60 });
    document = thermoform
      .restoreResult(old, 'Return', (name) => name in forming.parameters.properties)
      .apply(document);
    expect(thermoform.of(document).parameters).toEqual({ dots_per_inch: 150, vacuum_kpa: 60 });
  });

  it('joins what was made of the same sheet one after the other', () => {
    let document = addProduct(thermoform, product('p', {}, 'formed.glb')).apply(opened());
    document = addProduct(thermoform, product('q', {}, 'print.png')).apply(document);
    document = addProduct(thermoform, product('s', { dots_per_inch: 72 }, 'print.png')).apply(document);
    const craft = thermoform.of(document);
    expect(craft.products.map(({ id }) => id)).toEqual(['s', 'q']);
    expect(Object.keys(productOf(craft, subject.key, print)?.outputs ?? {}).sort()).toEqual([
      'formed.glb',
      'print.png',
    ]);
    expect(productOf(craft, subject.key, forming)).toBeNull();
  });

  it('lives beside a relief, and opens projects from before it', () => {
    const relief = new CraftCommands('relief', emptyCraft);
    const before = relief.openModel(all, model, 'Open', {}, () => false).apply(newDocument('1', 'One', 0));
    expect(thermoform.of(before)).toEqual({ ...emptyCraft, products: [] });
    const both = thermoform.setParameters(all, { vacuum_kpa: 50 }, 'Set').apply(before);
    expect(relief.of(both)).toEqual(relief.of(before));
    expect(thermoform.of(both).parameters).toEqual({ vacuum_kpa: 50 });
  });
});

describe('the colours of a model', () => {
  const withFiles = (...names: string[]) =>
    hasMaterials({
      kind: 'file',
      file_name: 'cat.obj',
      file: blob('a'),
      companions: names.map((file_name) => ({ file_name, file: blob('b') })),
    });

  it('are known where a file of materials came with it', () => {
    expect(withFiles('Cat.MTL', 'fur.png')).toBe(true);
    expect(withFiles('fur.png')).toBe(false);
    expect(withFiles()).toBe(false);
    expect(hasMaterials(model.source)).toBe(false);
  });
});
