// SPDX-License-Identifier: GPL-3.0-or-later
// Which mould, how many marks and how exactly they are measured; then what becomes of the numbers.
import { useId } from 'preact/hooks';
import type { Json, Operation } from '../../../jobs/contract';
import { Button } from '../../../ui';
import { download, safeFileName } from '../../../shared/session/download';
import { ParameterPanel } from '../../../shared/panels/parameters/parameter_panel';
import { sentences } from '../../../shared/session/report';
import { withoutDefaults } from '../../../shared/session/craft_document';
import { evidence, planning } from '../evidence_document';
import type { EvidenceSession } from '../evidence_session';
import type { ByHand, HandPlan } from './hand_marks';
import { measuredMarks, minMeasured, outlooksIn, problemOf } from './hand_marks';
import { rimProblem } from './rim';
import { keyOf, moulds, openingOf, planMarks, planNow, takeMarks } from './plan_marks';

const ownGroup = 'Measuring by hand';

/** What this is about first: elsewhere a sheet's and a machine's settings lead. */
function ownFirst(operation: Operation): Operation {
  const entries = Object.entries(operation.parameters.properties);
  const isOwn = ([, schema]: (typeof entries)[number]) => schema['x-group'] === ownGroup;
  return {
    ...operation,
    parameters: {
      properties: Object.fromEntries([...entries.filter(isOwn), ...entries.filter((entry) => !isOwn(entry))]),
    },
  };
}

export function HandInspector({ session, byHand }: { session: EvidenceSession; byHand: ByHand }) {
  const operation = session.operationNamed(planning);
  const { projects } = session.services;
  const id = useId();
  const plan = planNow(session, byHand);
  const all = moulds(session);
  const choose = (key: string) => {
    const mould = all.find((one) => keyOf(one) === key);
    if (mould === undefined) return;
    projects.do(evidence.changeByHand({ mould }, `Measure ${mould.title} by hand`));
    projects.commit();
  };
  const set = (name: string, value: Json) => {
    if (operation === undefined) return;
    const title = operation.parameters.properties[name]?.title ?? name;
    const parameters = withoutDefaults(operation, { ...byHand.parameters, [name]: value });
    projects.do(evidence.changeByHand({ parameters }, `Change ${title.toLowerCase()}`, name));
  };
  const shown =
    byHand.mould.kind === 'model' ? { ...byHand.mould.parameters, ...byHand.parameters } : byHand.parameters;
  return (
    <>
      <div class="inspector-scroll" tabIndex={-1}>
        <section class="section" aria-label="Measure by hand">
          <h3>Measure by hand</h3>
          <div class="field-line">
            <label for={id}>Mould</label>
            <select
              id={id}
              class="select"
              value={keyOf(byHand.mould)}
              onChange={(event) => choose(event.currentTarget.value)}
            >
              {all.map((mould) => (
                <option key={keyOf(mould)} value={keyOf(mould)}>
                  {mould.title}
                </option>
              ))}
            </select>
          </div>
          {plan ? <p class="hand-sentence">{shownOf(plan)}</p> : null}
          {plan ? sentences(plan.report, 'notes').map((note) => <p key={note}>{note}</p>) : null}
          <div class="row hand-tools">
            {plan ? (
              <Button size="small" icon="download" onClick={() => void saveDrawing(session, byHand, plan)}>
                Drawing at true size
              </Button>
            ) : null}
            <Button
              size="small"
              onClick={() => projects.do(evidence.setByHand(null, 'Leave measuring by hand'))}
            >
              {plan ? 'Remove the marks' : 'Leave'}
            </Button>
          </div>
        </section>
        {operation ? (
          <ParameterPanel
            operation={ownFirst(operation)}
            parameters={shown}
            errors={session.fieldErrors.value}
            onPreview={set}
            onCommit={() => projects.commit()}
            openGroups={[ownGroup]}
          />
        ) : null}
      </div>
      <div class="inspector-foot">
        <MainButtons session={session} byHand={byHand} plan={plan} />
      </div>
    </>
  );
}

function shownOf({ report }: HandPlan): string {
  const all = outlooksIn(report);
  const shown = all.filter(({ shows }) => shows).length;
  return `${shown} of ${all.length} causes would show at their usual strength. More marks, or a better gauge, show more.`;
}

interface MainButtonsProps {
  readonly session: EvidenceSession;
  readonly byHand: ByHand;
  readonly plan: HandPlan | null;
}

function MainButtons({ session, byHand, plan }: MainButtonsProps) {
  const busy = session.activity.value.kind !== 'idle' ? 'The marks are being chosen; Esc cancels' : undefined;
  const measured = plan ? measuredMarks(byHand, openingOf(byHand)).length : 0;
  const typed = byHand.marks.some((mark) => mark.typed.some((text) => text !== ''));
  if (plan === null)
    return (
      <>
        <Button
          kind="filled"
          size="big"
          disabledReason={busy}
          onClick={() => void planMarks(session, byHand)}
        >
          Choose the marks
        </Button>
        <p>
          {typed
            ? 'Another mould or other settings: the numbers typed for the old marks go'
            : 'About a hundred small simulations'}
        </p>
      </>
    );
  const wrong = byHand.marks.findIndex((mark) => problemOf(mark, byHand.origin, openingOf(byHand)) !== '');
  const wrongRim = byHand.rim?.find((reading) => rimProblem(reading) !== '');
  const notRight =
    wrong >= 0 ? `Mark ${wrong + 1}` : wrongRim ? `The rim’s thickness, ${wrongRim.side},` : undefined;
  const unfinished = notRight && `${notRight} is not right yet: read it once more, or leave it blank`;
  const few =
    measured < minMeasured
      ? `${measured} of ${byHand.marks.length} marks are measured; ${minMeasured} are the fewest that a diagnosis takes`
      : undefined;
  return (
    <>
      <Button
        kind="filled"
        size="big"
        disabledReason={busy ?? unfinished ?? few}
        onClick={() => void takeMarks(session, byHand)}
      >
        Use these measurements
      </Button>
      {measured > 0 ? (
        <Button
          size="small"
          class="hand-further"
          title="Keeps those that are measured, and chooses others beside them"
          disabledReason={busy ?? unfinished}
          onClick={() => void planMarks(session, byHand)}
        >
          Choose further marks
        </Button>
      ) : null}
      <p>{unfinished ?? few ?? 'They become a measured object, which you can diagnose'}</p>
    </>
  );
}

async function saveDrawing(
  session: EvidenceSession,
  { mould }: ByHand,
  { drawing }: HandPlan,
): Promise<void> {
  const bytes = await session.services.projects.blobs.read(drawing.blob);
  download(bytes, `${safeFileName(mould.title)}-marks.svg`, drawing.media_type);
}
