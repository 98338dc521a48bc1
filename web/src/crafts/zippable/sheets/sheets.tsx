// SPDX-License-Identifier: GPL-3.0-or-later
// The sheets that the ribbon is cut from, as the plan's own drawing has them.
import { useEffect, useState } from 'preact/hooks';
import { Button, formatCount, formatMetres, formatNumber, Icon, Menu, withUnit } from '../../../ui';
import { solveInFull } from '../../../shared/session/full_solve';
import { figure } from '../../../shared/session/report';
import { notesOf } from '../../../shared/session/report_notes';
import { planBytes } from '../make_product';
import type { Sheet } from './sheet_drawing';
import { readSheets } from './sheet_drawing';
import { SheetStage } from './sheet_stage';
import type { SendToMachine } from './send_sheet';
import { sendSheet, sheetCount, sheetName } from './send_sheet';
import type { ZippableSession } from '../zippable_session';
import './sheets.css';

/** Plans asked for already: what failed is not tried again before something changes. */
const tried = new Set<string>();

/** The one that this view asked for and that is being made. */
let inWork: string | null = null;
/** While a value is typed or dragged, the plan in work for the one before is not given up at once. */
const settled_ms = 300;

const planKey = ({ designFile, sheets }: ZippableSession): string =>
  JSON.stringify([designFile.value?.blob, sheets.parameters.value]);

/** Where the values change meanwhile, the next plan ends this one, which may be asked for again. */
async function makePlan(session: ZippableSession): Promise<void> {
  const key = planKey(session);
  tried.add(key);
  inWork = key;
  const made = await planBytes(session, 'plan.svg', 'plan');
  if (made === null && planKey(session) !== key) tried.delete(key);
  if (inWork === key) inWork = null;
}

export interface SheetsProps {
  readonly session: ZippableSession;
  readonly drawing: 'plan.svg' | 'rig.svg';
  readonly onSendToMachine: SendToMachine;
}

export function Sheets({ session, drawing, onSendToMachine }: SheetsProps) {
  const design = session.designFile.value;
  const plan = session.plan.value;
  const parameters = session.sheets.parameters.value;
  const idle = session.activity.value.kind === 'idle';
  useEffect(() => {
    if (design === null || plan !== null || tried.has(planKey(session))) return;
    if (!idle && inWork === null) return;
    const soon = setTimeout(() => void makePlan(session), idle ? 0 : settled_ms);
    return () => clearTimeout(soon);
  }, [design, plan, parameters, idle]);
  const rig = drawing === 'rig.svg';
  const words = rig ? rigWords(session) : planWords(session);
  const sheets = useSheets(session, drawing);
  if (design === null)
    return (
      <div class="sheets-empty">
        <p>The cutting plan is made of the whole model’s ribbon, which is not made yet.</p>
        <Button
          icon="scissors"
          disabledReason={
            session.shown.value === null || !idle ? 'Available when the preview is ready' : undefined
          }
          onClick={() => void solveInFull(session)}
        >
          Make the ribbon
        </Button>
      </div>
    );
  const notes = notesOf(plan?.report ?? {}, 'notes');
  return (
    <div class="sheets">
      {plan && sheets ? (
        <SheetStage
          sheets={sheets}
          words={words}
          label={rig ? 'Fastening rig' : 'Sheets to cut'}
          nameOf={(sheet) => (rig ? `Board ${sheet + 1}` : sheetName(session, sheet))}
        />
      ) : null}
      {plan === null && idle ? (
        <div class="sheets-empty">
          <p>No cutting plan was made. If a note on the model says why, change that first.</p>
          <Button icon="scissors" onClick={() => void planBytes(session, 'plan.svg', 'plan')}>
            Make the cutting plan
          </Button>
        </div>
      ) : null}
      {plan ? (
        <div class="sheets-foot">
          <p>{words}</p>
          {rig ? null : <SendButton session={session} onSendToMachine={onSendToMachine} />}
          {notes.length > 0 ? (
            <details>
              <summary>
                <Icon name="warn" small /> {notes.length === 1 ? '1 note' : `${notes.length} notes`}
              </summary>
              <ul>
                {notes.map(({ sentence, fix }) => (
                  <li key={sentence}>
                    {sentence}{' '}
                    {fix ? (
                      <button
                        type="button"
                        class="text-button"
                        onClick={() => session.setParameters(fix.parameters, fix.label)}
                      >
                        {fix.label}
                      </button>
                    ) : null}
                  </li>
                ))}
              </ul>
            </details>
          ) : null}
        </div>
      ) : null}
    </div>
  );
}

/** One sheet at once, of several the one that is chosen. */
function SendButton({ session, onSendToMachine }: Omit<SheetsProps, 'drawing'>) {
  const idle = session.activity.value.kind === 'idle';
  const count = sheetCount(session);
  const send = (sheet: number) => void sendSheet(session, sheet, onSendToMachine);
  if (count === 1)
    return (
      <Button
        size="small"
        icon="machines"
        disabledReason={idle ? undefined : 'A file is being made or opened'}
        onClick={() => send(0)}
      >
        Send to a machine
      </Button>
    );
  return (
    <Menu
      buttonClass="button small"
      items={Array.from({ length: count }, (_, sheet) => ({
        label: sheetName(session, sheet),
        disabledReason: idle ? undefined : 'A file is being made or opened',
        onSelect: () => send(sheet),
      }))}
    >
      <Icon name="machines" /> Send to a machine <Icon name="chevronDown" small />
    </Menu>
  );
}

const many = (count: number, one: string) => `${formatCount(count)} ${one}${count === 1 ? '' : 's'}`;

/** "15 plates on 4 boards; 36 screws". */
function rigWords(session: ZippableSession): string {
  const report = session.plan.value?.report ?? {};
  const [plates, boards, screws] = ['rig_plates', 'rig_sheets', 'rig_screws'].map((name) =>
    figure(report, name),
  );
  return plates && boards && screws
    ? `${many(plates, 'plate')} on ${many(boards, 'board')}; ${many(screws, 'screw')}`
    : '';
}

/** "7 pieces on 2 sheets of 600 × 300 mm; zipper to cut: 2.57 m". */
function planWords(session: ZippableSession): string {
  const report = session.plan.value?.report ?? {};
  const pieces = Array.isArray(report['pieces']) ? report['pieces'].length : null;
  const [sheets, zipper] = [figure(report, 'sheets'), figure(report, 'zipper_to_cut_mm')];
  const bed = ['bed_x_mm', 'bed_y_mm']
    .map((name) => session.sheets.value(name))
    .filter((mm) => typeof mm === 'number');
  const size =
    bed.length === 2 ? ` of ${withUnit(bed.map((mm) => formatNumber(mm, 3)).join(' × '), 'mm')}` : '';
  return [
    pieces !== null && sheets !== null ? `${many(pieces, 'piece')} on ${many(sheets, 'sheet')}${size}` : null,
    zipper === null ? null : `zipper to cut: ${formatMetres(zipper)}`,
  ]
    .filter(Boolean)
    .join('; ');
}

/** The sheets of the plan's drawing while it is shown. */
function useSheets(session: ZippableSession, name: string): readonly Sheet[] | null {
  const [read, setRead] = useState<{ readonly of: string; readonly sheets: readonly Sheet[] } | null>(null);
  const drawing = session.plan.value?.outputs[name];
  useEffect(() => {
    let gone = false;
    const take = async () => {
      if (drawing === undefined) return;
      const bytes = await session.services.projects.blobs.read(drawing.blob);
      if (!gone) setRead({ of: drawing.blob, sheets: readSheets(new TextDecoder().decode(bytes)) });
    };
    void take().catch(() => undefined);
    return () => void (gone = true);
  }, [drawing?.blob]);
  return read !== null && read.of === drawing?.blob ? read.sheets : null;
}
