// SPDX-License-Identifier: GPL-3.0-or-later
import { Button } from '../../../ui';
import type { ReliefSession } from '../relief_session';
import './forest_button.css';

/** Beside the views of the relief, and in the empty room: the forest needs no model of one's own. */
export function ForestButton({ session }: { readonly session: ReliefSession }) {
  if (session.forest.operation.value === null) return null; // an older worker
  return (
    <Button
      title="Several models on free-standing pillars, each seen from its own viewpoint"
      onClick={() => session.forest.show(true)}
    >
      Pillar forest
    </Button>
  );
}
