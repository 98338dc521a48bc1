// SPDX-License-Identifier: GPL-3.0-or-later
// In the inspector: opens the paint, and says what is painted.
import { Button } from '../../../ui';
import type { ReliefSession } from '../relief_session';
import { kindNames } from './paint_session';
import { counts, paintKinds } from './painted_values';

export function PaintButton({ session }: { readonly session: ReliefSession }) {
  const { paint } = session;
  const painted = paint.painted.value;
  const offered = session.operation.value?.inputs.some(({ name }) => name === 'painting') ?? false;
  if (!offered) return null;
  const of = painted ? counts(painted.values) : null;
  const kinds = of ? paintKinds.filter((kind) => of[kind] > 0) : [];
  return (
    <div class="paint-row">
      <div class="row">
        <Button
          class="grow"
          icon="pencil"
          disabledReason={painted === null ? 'Available when the model is read' : undefined}
          title="Paint which parts matter more, lie on the base or stand out"
          onClick={() => (paint.open.value = !paint.open.peek())}
        >
          {paint.open.value ? 'Done painting' : 'Paint the model'}
        </Button>
        {kinds.length > 0 ? <Button onClick={() => void paint.clearAll()}>Clear</Button> : null}
      </div>
      {kinds.length > 0 ? <p>Painted: {kinds.map((kind) => kindNames[kind]).join(', ')}.</p> : null}
    </div>
  );
}
