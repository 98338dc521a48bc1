// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps the sheets in step with the chosen laser, and the project with the laser that it was laid out for.
import type { ReadonlySignal } from '@preact/signals';
import { computed, effect, untracked } from '@preact/signals';
import type { Json, JsonObject, Operation } from '../../jobs/contract';
import { findOperation } from '../../jobs/contract';
import type { LaserSheet } from '../../machines/laser_sheet';
import { sameBed } from '../../machines/laser_sheet';
import { inForce } from '../../shared/session/craft_document';
import type { RoomSession } from '../../shared/session/room_session';
import { automaticSizes, hasPlan, laserOf, planParameters } from './sheet_size';
import type { ZippableDocument } from './zippable_document';
import { layOutFor, noteLaser, planning } from './zippable_document';

export class LaserSheets {
  readonly #session: RoomSession<ZippableDocument>;
  /** The chosen laser; null while it is not known. */
  readonly chosen: ReadonlySignal<LaserSheet | null>;
  /** The one that plans are laid out for; null where the operation's own sizes count. */
  readonly laser = computed(() => laserOf(this.#session.document.value, this.chosen.value));
  /** What plans are made with. */
  readonly parameters = computed((): JsonObject => {
    const operation = this.#planning();
    return operation ? planParameters(operation, this.#session.document.value, this.chosen.value) : {};
  });
  /** What the values come to that the maker left open. */
  readonly automatic = computed((): Record<string, number> => {
    const operation = this.#planning();
    return operation ? automaticSizes(operation, this.#session.document.value, this.chosen.value) : {};
  });

  constructor(session: RoomSession<ZippableDocument>, chosen: ReadonlySignal<LaserSheet | null>) {
    this.#session = session;
    this.chosen = chosen;
    this.#follow();
  }

  #planning(): Operation | undefined {
    const catalog = this.#session.services.catalog.value;
    return catalog ? findOperation(catalog, planning) : undefined;
  }

  /** In force for plans, what the laser says included. */
  value(name: string): Json {
    const operation = this.#planning();
    return operation ? inForce(operation, this.parameters.value, name) : null;
  }

  /** Another laser is chosen, or its bed is changed, while this project is open: what is laid out follows. Opening a project while
   *  another laser is chosen changes nothing. Nor does another kerf: a sheet that is still to be cut must go with those that
   *  are cut already, and the laser's job corrects the difference. */
  #follow(): void {
    const { document, services } = this.#session;
    let [project, before] = ['', null as LaserSheet | null];
    effect(() => {
      const chosen = this.chosen.value;
      const { id } = services.projects.document.value;
      untracked(() => {
        const other = id === project && before !== null && chosen !== null && !sameBed(before, chosen);
        [project, before] = [id, chosen];
        if (other && chosen !== null && hasPlan(document.value)) services.projects.do(noteLaser(chosen));
      });
    });
  }

  /** Before a plan is made: from now on the project keeps the laser that it is laid out for. */
  note(): void {
    const { document, services } = this.#session;
    const chosen = this.chosen.value;
    if (chosen !== null && !hasPlan(document.value)) services.projects.do(noteLaser(chosen));
  }

  /** As large as the chosen laser's bed, whatever was set by hand. */
  useLaser(): void {
    const { projects } = this.#session.services;
    const chosen = this.chosen.value;
    if (chosen === null) return;
    projects.do(layOutFor(chosen, `Lay out for ${chosen.laser}`));
    projects.commit();
  }

  /** The same for a bed of this size, as the machine that did not take a sheet has it. */
  useBed([bed_x_mm, bed_y_mm]: readonly [number, number]): void {
    const chosen = this.chosen.value;
    if (chosen?.bed_x_mm === bed_x_mm && chosen.bed_y_mm === bed_y_mm) this.useLaser();
    else this.#session.setParameters({ bed_x_mm, bed_y_mm }, `Lay out for ${bed_x_mm} × ${bed_y_mm} mm`);
  }

  /** The size in force becomes one that is set by hand, to be changed. */
  setByHand(): void {
    const [bed_x_mm, bed_y_mm] = [this.value('bed_x_mm'), this.value('bed_y_mm')];
    if (typeof bed_x_mm === 'number' && typeof bed_y_mm === 'number')
      this.#session.setParameters({ bed_x_mm, bed_y_mm }, 'Use another sheet size');
  }
}
