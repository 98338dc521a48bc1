// SPDX-License-Identifier: GPL-3.0-or-later
// Over the model while it is painted: the kinds of paint, the brush, what is painted, and ways to paint without pointing.
import { useEffect } from 'preact/hooks';
import { Button, Icon, IconButton, Menu, Parameter } from '../../../ui';
import type { Insets, Viewport } from '../../../view';
import type { ReliefSession } from '../relief_session';
import { kindColours } from './paint_scene';
import type { Fill } from './paint_session';
import { kindNames } from './paint_session';
import type { PaintKind } from './painted_values';
import { counts, paintKinds } from './painted_values';
import './paint.css';

interface ToolProps {
  readonly session: ReliefSession;
  readonly viewport: Viewport | null;
  /** What the view leaves free of floating panels. */
  readonly free: () => Insets;
}

const kindHelp: Readonly<Record<PaintKind, string>> = {
  more: 'The shape is kept better here, at the cost of other places.',
  less: 'The shape may change here first.',
  free: 'May stand out as far as it likes.',
  on_base: 'Lies exactly on the base.',
  own_thickness: 'Stands out as far as is set here, not as far as the rest.',
};

const eraseHelp = 'Takes all paint away.';

const fills: readonly { readonly what: Fill; readonly label: string }[] = [
  { what: 'facing', label: 'The side towards the viewer' },
  { what: 'away', label: 'The side away from the viewer' },
  { what: 'outline', label: 'The outline' },
  { what: 'part', label: 'The part in the middle of the view' },
  { what: 'all', label: 'The whole model' },
];

export function PaintTool({ session, viewport, free }: ToolProps) {
  const { paint } = session;
  useEffect(() => {
    // The first question about what lies under the pointer is answered once a search tree is there: it is asked now.
    viewport?.pick(0, 0);
  }, [viewport]);
  if (viewport === null) return null;
  /** Of what floating panels leave free. The search tree that answers may still be on its way. */
  const middle = async () => {
    const { clientWidth, clientHeight } = viewport.overlay;
    const { left, top, right, bottom } = free();
    const at = [(left + clientWidth - right) / 2, (top + clientHeight - bottom) / 2] as const;
    const hit = viewport.pick(...at);
    if (hit) return hit;
    await viewport.settled();
    return viewport.pick(...at);
  };
  const dabInTheMiddle = async () => {
    const hit = await middle();
    if (hit) paint.dab(hit);
    await paint.endStroke();
  };
  return (
    <div class="float top-left paint-tool" role="group" aria-label="Paint the model">
      <div class="panel paint-panel">
        <div class="row">
          <strong class="grow">Paint the model</strong>
          <Button size="small" icon="check" onClick={() => (paint.open.value = false)}>
            Done
          </Button>
        </div>
        <Kinds session={session} />
        <p class="paint-words">{paint.kind.value === null ? eraseHelp : kindHelp[paint.kind.value]}</p>
        <Brush session={session} />
        <div class="row">
          <Menu
            buttonClass="button outlined small"
            title="Paints without pointing"
            items={fills.map(({ what, label }) => ({
              label,
              onSelect: () => void middle().then((hit) => paint.fill(what, hit)),
            }))}
          >
            Fill <Icon name="chevronDown" small />
          </Menu>
          <Button
            size="small"
            icon="plus"
            title="One dab of the brush where the middle of the view is; arrow keys turn the model"
            onClick={() => void dabInTheMiddle()}
          >
            Dab in the middle
          </Button>
        </div>
      </div>
    </div>
  );
}

/** The paints, which are their own legend, with how much of each there is. */
function Kinds({ session }: { readonly session: ReliefSession }) {
  const { paint } = session;
  const painted = paint.painted.value;
  const of = painted ? counts(painted.values) : null;
  const vertices = painted?.values.region.length ?? 1;
  const chosen = paint.kind.value;
  return (
    <div class="paint-kinds" role="group" aria-label="Paint">
      {[...paintKinds, null].map((kind) => {
        const count = kind && of ? of[kind] : 0;
        const name = kind === null ? 'Erase' : kindNames[kind];
        return (
          <div key={name} class="row paint-kind">
            <label class="grow" title={kind === null ? eraseHelp : kindHelp[kind]}>
              <input
                type="radio"
                name="paint-kind"
                checked={chosen === kind}
                onChange={() => (paint.kind.value = kind)}
              />
              <span
                class="paint-swatch"
                style={kind ? { background: `var(${kindColours[kind]})` } : {}}
                aria-hidden="true"
              />
              {name}
            </label>
            {kind && count > 0 ? (
              <>
                <span class="paint-share">{shareText(count / vertices)}</span>
                <IconButton icon="trash" label={`Clear “${name}”`} onClick={() => void paint.clear(kind)} />
              </>
            ) : null}
          </div>
        );
      })}
    </div>
  );
}

/** "12 %" of the vertices. */
const shareText = (share: number): string => (share < 0.005 ? '< 1 %' : `${Math.round(100 * share)} %`);

function Brush({ session }: { readonly session: ReliefSession }) {
  const { paint } = session;
  const kind = paint.kind.value;
  const commit = () => undefined;
  return (
    <>
      <Parameter
        label="Brush"
        help="Radius of the brush on the model, in millimetres of the finished relief."
        unit="mm"
        minimum={0.1}
        maximum={500}
        slider={[1, 40]}
        defaultValue={6}
        value={paint.radius_mm.value}
        onPreview={(value) => (paint.radius_mm.value = value ?? 6)}
        onCommit={commit}
      />
      {kind === 'more' || kind === 'less' ? (
        <Parameter
          label="How much"
          help="How many times as much the shape matters here, or how many times less."
          unit=""
          minimum={1.1}
          maximum={100}
          slider={[1.1, 20]}
          defaultValue={4}
          value={paint.factor.value}
          onPreview={(value) => (paint.factor.value = value ?? 4)}
          onCommit={commit}
        />
      ) : null}
      {kind === 'own_thickness' ? (
        <Parameter
          label="Thickness here"
          help="How far the painted places may stand out from the base."
          unit="mm"
          minimum={0}
          maximum={1000}
          slider={[0, 40]}
          defaultValue={10}
          value={paint.thickness_mm.value}
          onPreview={(value) => (paint.thickness_mm.value = value ?? 10)}
          onCommit={commit}
        />
      ) : null}
    </>
  );
}
