// SPDX-License-Identifier: GPL-3.0-or-later
// Which way up the model stands, by buttons; the numbers are among the advanced parameters.
import { useId } from 'preact/hooks';
import { Button, tipHandlers } from '../../../ui';
import type { ThermoformSession } from '../thermoform_session';
import type { FaceTool } from './face_tool';
import type { Side } from './stance';
import { layOn, standAsInFile, standsAsInFile } from './stand_model';

const buttons: readonly { readonly side: Side; readonly label: string; readonly rest?: string }[] = [
  { side: 'left', label: 'Left', rest: ' side' },
  { side: 'right', label: 'Right', rest: ' side' },
  { side: 'front', label: 'Front' },
  { side: 'back', label: 'Back' },
  { side: 'top', label: 'Top' },
];

export function StandButtons({ session, tool }: { session: ThermoformSession; tool: FaceTool }) {
  const id = useId();
  return (
    <div class="stand">
      <div role="group" aria-labelledby={id}>
        <span
          id={id}
          class="stand-label"
          {...tipHandlers(
            'Tips the model over by its own axes. Left, right, front and back are those of the model as it stands now, seen from the front of the machine. Its size stays.',
            'left',
          )}
        >
          Lay the model on its
        </span>
        <div class="stand-row">
          {buttons.map(({ side, label, rest }) => (
            <Button key={side} size="small" onClick={() => layOn(session, side)}>
              {label}
              {rest ? <span class="hidden-text">{rest}</span> : null}
            </Button>
          ))}
        </div>
      </div>
      <div class="stand-row">
        <Button
          size="small"
          buttonRef={tool.opener}
          title="Choose a flat side of the model that comes to lie on the plate."
          onClick={() => void tool.toggle()}
        >
          Place on face
        </Button>
        <Button
          size="small"
          disabledReason={standsAsInFile(session) ? 'The model stands as in its file.' : undefined}
          onClick={() => standAsInFile(session)}
        >
          Stand as in the file
        </Button>
      </div>
    </div>
  );
}
