// SPDX-License-Identifier: GPL-3.0-or-later
// The relief's parameters and its one filled button.
import { useState } from 'preact/hooks';
import type { Operation, OutputDeclaration } from '../../jobs/contract';
import {
  Button,
  Dialog,
  formatBytes,
  formatDuration,
  IconButton,
  Icon,
  Menu,
  Switch,
  withUnit,
} from '../../ui';
import type { Viewport } from '../../view';
import { ParameterPanel } from '../../shared/panels/parameters/parameter_panel';
import { readyWorker } from '../../shared/session/services';
import type { CraftResult } from '../../shared/session/craft_document';
import { download, safeFileName } from '../../shared/session/download';
import { browserMemory_mb, timeLine } from '../../shared/session/estimate';
import { ModelRow } from '../../shared/panels/model_row';
import { printInPlastic } from '../../shared/print/print_request';
import { outputOf } from '../../shared/session/full_solve';
import { howMadeItem } from '../../shared/session/how_made';
import { BaseFile } from './base/base_file';
import { GroupList } from './group/group_list';
import { placesBase } from './relief_document';
import type { ReliefSession } from './relief_session';
import type { SendToMill } from './send_relief';
import { sendRelief } from './send_relief';
import { solidLine } from './report';
import { LightPanel } from './light/light_panel';
import { PaintButton } from './paint/paint_button';
import { atViewpoint, followCamera, mode } from './viewport_panel';

export interface InspectorProps {
  readonly session: ReliefSession;
  readonly viewport: Viewport | null;
  readonly picture: string | null;
  readonly onReplace: () => void;
  readonly onSolve: () => void;
  readonly onSendToMill: SendToMill;
}

export function Inspector(props: InspectorProps) {
  const { session, viewport, picture, onReplace } = props;
  const { model, parameters } = session.document.value;
  const operation = session.operation.value;
  if (model === null || operation === null) return null;
  // Groups stand in this order.
  const head = {
    Viewpoint: <ViewpointTools session={session} viewport={viewport} />,
    Relief: null,
    Base: <BaseFile session={session} />,
  };
  const shown = session.document.value.base ? withoutShape(operation) : withoutPlace(operation);
  return (
    <>
      <div class="inspector-scroll" tabIndex={-1}>
        <ModelRow session={session} picture={picture} onReplace={onReplace} />
        <GroupList session={session} />
        <PaintButton session={session} />
        {mode.value === 'light' ? <LightPanel session={session} /> : null}
        <ParameterPanel
          operation={shown}
          parameters={parameters}
          errors={session.fieldErrors.value}
          onPreview={(name, value) => session.preview(name, value)}
          onCommit={() => session.services.projects.commit()}
          groupHead={head}
        />
      </div>
      <div class="inspector-foot">
        <MainButton {...props} />
      </div>
    </>
  );
}

/** A base from a file has no built-in shape beside it. */
function withoutShape(operation: Operation): Operation {
  const { base: _, ...properties } = operation.parameters.properties;
  return { ...operation, parameters: { properties } };
}

/** Only a base from a file can be moved. */
function withoutPlace(operation: Operation): Operation {
  const properties = Object.fromEntries(
    Object.entries(operation.parameters.properties).filter(([name]) => !placesBase(name)),
  );
  return { ...operation, parameters: { properties } };
}

function ViewpointTools({ session, viewport }: { session: ReliefSession; viewport: Viewport | null }) {
  const at = atViewpoint.value;
  return (
    <>
      <div class="row">
        <Button
          class="grow"
          icon="lock"
          disabledReason={
            at ? 'The relief is made for this view already. Turn the model to choose another one.' : undefined
          }
          title="Makes the relief for the view you see now"
          onClick={() => {
            if (viewport === null) return;
            session.setViewpoint(viewport.getCameraAsViewpoint());
            viewport.setViewpoint(viewport.getCameraAsViewpoint());
            atViewpoint.value = true;
          }}
        >
          Use this view
        </Button>
        <IconButton
          icon="eye"
          class="outlined"
          label="Look from the relief’s viewpoint"
          keys="0"
          pressed={at}
          onClick={() => viewport?.lookFromViewpoint(true)}
        />
      </div>
      <Switch
        label="Follow the view"
        help="The viewpoint moves with the picture while you turn the model."
        value={followCamera.value}
        onChange={(value) => {
          followCamera.value = value;
          if (value && viewport) session.setViewpoint(viewport.getCameraAsViewpoint());
          else session.services.projects.commit();
        }}
      />
    </>
  );
}

function MainButton({ session, onSolve, onSendToMill }: InspectorProps) {
  const [confirm, setConfirm] = useState(false);
  const activity = session.activity.value;
  const result = session.result.value;
  if (activity.kind === 'solving')
    return (
      <>
        <Button kind="filled" size="big" disabledReason="The relief is being solved; Esc cancels">
          Solving at full detail
        </Button>
        <p>Earlier results are kept. Esc cancels.</p>
      </>
    );
  if (result) return <ExportButton session={session} result={result} onSendToMill={onSendToMill} />;
  const estimate = session.estimate.value;
  const worker = readyWorker(session.services) !== null;
  const memory = estimate?.memory_mb ?? 0;
  const tight = !worker && memory > 0.5 * browserMemory_mb;
  return (
    <>
      <Button
        kind="filled"
        size="big"
        disabledReason={
          session.shown.value === null
            ? 'Available when the preview is ready'
            : activity.kind === 'idle'
              ? undefined
              : 'A file is being made or opened'
        }
        onClick={() => (tight ? setConfirm(true) : onSolve())}
      >
        Solve at full detail
      </Button>
      <p>{timeLine(estimate, worker)}</p>
      {confirm ? (
        <Dialog title="Solve in the browser?" onClose={() => setConfirm(false)}>
          <p>
            This model needs about {formatBytes(memory * 1e6)} of memory
            {estimate?.browser_s ? ` and ${formatDuration(estimate.browser_s)}` : ''} in the browser, which
            ends at {withUnit('4', 'GB')}. The worker program on your own computer has no such limit. Your
            work is saved either way.
          </p>
          <div class="row end">
            <Button onClick={() => setConfirm(false)}>Keep the preview</Button>
            <Button
              kind="filled"
              onClick={() => {
                setConfirm(false);
                onSolve();
              }}
            >
              Solve here
            </Button>
          </div>
        </Dialog>
      ) : null}
    </>
  );
}

interface ExportProps {
  readonly session: ReliefSession;
  readonly result: CraftResult;
  readonly onSendToMill: SendToMill;
}

function ExportButton({ session, result, onSendToMill }: ExportProps) {
  const all = session.operation.value?.outputs ?? [];
  const files = all.filter((output) => output.name !== 'relief.ply');
  const main = files.find((output) => output.name === 'relief.stl') ?? files[0];
  const busy = session.activity.value.kind === 'idle' ? undefined : 'Another file is being made';
  const save = async (output: OutputDeclaration) => {
    const fileName = fileNameOf(session, output.name); // as it is now: making the file may take a while
    const bytes = await outputOf(session, output.name, output.label);
    if (bytes) download(bytes, fileName, output.media_type);
  };
  if (main === undefined) return null;
  const size = result.outputs[main.name]?.bytes;
  return (
    <>
      <div class="split">
        <Button
          kind="filled"
          size="big"
          icon="download"
          disabledReason={busy}
          onClick={() => void save(main)}
        >
          Export {main.label}
        </Button>
        <Menu
          label="Export another format"
          buttonClass="button filled big"
          align="right"
          items={[
            {
              label: 'Send to a 3D printer',
              icon: 'machines' as const,
              disabledReason: busy,
              onSelect: () => void printSolid(session),
            },
            null,
            ...[...files, ...all.filter((output) => output.name === 'relief.ply')].map((output) => {
              const kept = result.outputs[output.name];
              const ofPieces = /^(pieces|placement)\./.test(output.name);
              return {
                label: output.name === 'relief.ply' ? `${output.label}, for measuring` : output.label,
                hint: kept ? formatBytes(kept.bytes) : undefined,
                disabledReason:
                  ofPieces && !session.pieces.possible.value
                    ? 'Only stairs, strips and a base file of several parts have pieces'
                    : busy,
                onSelect: () => void save(output),
              };
            }),
            howMadeItem(session.title, session.document.value.model, result),
          ]}
        >
          <Icon name="chevronDown" small />
        </Menu>
      </div>
      <p>
        {solidLine(result.report)}
        {size ? `, ${formatBytes(size)}` : ''}
      </p>
      <Button
        class="send-on"
        icon="machines"
        disabledReason={busy}
        onClick={() => void sendRelief(session, onSendToMill)}
      >
        Send to a machine
      </Button>
    </>
  );
}

async function printSolid(session: ReliefSession): Promise<void> {
  const bytes = await outputOf(session, 'relief.stl', 'relief');
  if (bytes) printInPlastic({ title: `the relief of ${session.title}`, fileName: 'relief.stl', bytes });
}

export const exportMain = async (session: ReliefSession): Promise<void> => {
  const output = session.operation.value?.outputs.find(({ name }) => name === 'relief.stl');
  if (session.activity.value.kind !== 'idle') return;
  const fileName = fileNameOf(session, 'relief.stl');
  const bytes = output ? await outputOf(session, output.name, output.label) : null;
  if (bytes && output) download(bytes, fileName, output.media_type);
};

/** "lion-relief-5mm.stl". */
function fileNameOf(session: ReliefSession, output: string): string {
  const [stem = 'relief', extension = ''] = output.split('.');
  const thickness = session.value('thickness_mm');
  return `${safeFileName(session.title)}-${stem}-${String(thickness)}mm.${extension}`;
}
