// SPDX-License-Identifier: GPL-3.0-or-later
// The scene in numbers, the parameters of the forest, and the one filled button.
import { useRef } from 'preact/hooks';
import type { Operation, OutputDeclaration } from '../../../jobs/contract';
import { Button, formatBytes, formatFixed, Icon, Menu, withUnit } from '../../../ui';
import { ParameterPanel } from '../../../shared/panels/parameters/parameter_panel';
import { download, safeFileName } from '../../../shared/session/download';
import { timeLine } from '../../../shared/session/estimate';
import { howMadeItem } from '../../../shared/session/how_made';
import { figure } from '../../../shared/session/report';
import { readyWorker } from '../../../shared/session/services';
import type { ForestResult } from './forest_document';
import type { ForestSession } from './forest_session';
import { SceneList } from './list/scene_list';
import { view } from './views';

export interface ForestInspectorProps {
  readonly session: ForestSession;
  readonly onChooseFile: () => void;
}

const openGroups = ['Pillars', 'Relief'];

export function ForestInspector({ session, onChooseFile }: ForestInspectorProps) {
  const operation = session.operation.value;
  if (operation === null) return null;
  const scene = session.scene.value;
  const { parameters, scene: own } = session.document.value;
  return (
    <>
      <div class="inspector-scroll" tabIndex={-1}>
        {scene ? <SceneList session={session} scene={scene} onChooseFile={onChooseFile} /> : null}
        <ParameterPanel
          operation={own ? withoutSample(operation) : operation}
          parameters={parameters}
          errors={session.fieldErrors.value}
          onPreview={(name, value) => session.preview(name, value)}
          onCommit={() => session.commit()}
          groupHead={groupHead}
          openGroups={openGroups}
        />
        <SceneFiles session={session} />
      </div>
      <div class="inspector-foot">
        <MainButton session={session} />
      </div>
    </>
  );
}

/** Pillars come first: they are what one tries out. */
const groupHead = { Pillars: null, Relief: null };

/** A scene of one's own says itself how fine its samples are. */
function withoutSample(operation: Operation): Operation {
  const { scene_vertices: _, ...properties } = operation.parameters.properties;
  return { ...operation, parameters: { properties } };
}

function SceneFiles({ session }: { session: ForestSession }) {
  const input = useRef<HTMLInputElement>(null);
  const own = session.document.value.scene !== null;
  return (
    <section class="section" aria-label="Scene">
      <h3>Scene</h3>
      <div class="row wrap">
        <Button size="small" icon="upload" onClick={() => input.current?.click()}>
          Open a scene
        </Button>
        <Button
          size="small"
          disabledReason={own ? undefined : 'This is the sample'}
          onClick={() => session.useSample()}
        >
          Start again from the sample
        </Button>
      </div>
      <input
        ref={input}
        type="file"
        hidden
        aria-label="Scene file"
        accept=".json"
        onChange={({ currentTarget }) => {
          const files = [...(currentTarget.files ?? [])];
          currentTarget.value = '';
          if (files.length > 0) void session.openFiles(files);
        }}
      />
    </section>
  );
}

function MainButton({ session }: { session: ForestSession }) {
  const activity = session.activity.value;
  const result = session.result.value;
  if (activity.kind === 'solving')
    return (
      <>
        <Button kind="filled" size="big" disabledReason="The forest is being made; Esc cancels">
          Making the forest
        </Button>
        <p>Earlier forests are kept. Esc cancels.</p>
      </>
    );
  if (result) return <ExportButton session={session} result={result} />;
  const problem = session.plan.problem.value;
  const reason =
    session.scene.value === null
      ? (problem ?? 'Available when the plan is ready')
      : activity.kind === 'idle'
        ? undefined
        : 'A file is being opened or made';
  return (
    <>
      <Button kind="filled" size="big" disabledReason={reason} onClick={() => void makeForest(session)}>
        Make the forest
      </Button>
      <p>{timeLine(session.estimate.value, readyWorker(session.services) !== null)}</p>
    </>
  );
}

/** Then it is shown as it is seen from its viewpoints. */
export async function makeForest(session: ForestSession): Promise<void> {
  if (session.result.value === null) await session.make();
  if (session.result.value !== null) view.value = 'pictures';
}

export async function saveOutput(session: ForestSession, output: OutputDeclaration): Promise<void> {
  const bytes = await session.outputOf(output.name, output.label);
  if (bytes) download(bytes, `${safeFileName(session.title)}-${output.name}`, output.media_type);
}

function ExportButton({ session, result }: { session: ForestSession; result: ForestResult }) {
  const outputs = session.operation.value?.outputs ?? [];
  const [main] = outputs;
  if (main === undefined) return null;
  const busy = session.activity.value.kind === 'idle' ? undefined : 'Another file is being made';
  const { report } = result;
  const volume = figure(report, 'volume_ml');
  const closed = report['watertight'] === true ? 'Watertight' : 'Not watertight';
  return (
    <>
      <div class="split">
        <Button
          kind="filled"
          size="big"
          icon="download"
          disabledReason={busy}
          onClick={() => void saveOutput(session, main)}
        >
          Export {main.label}
        </Button>
        <Menu
          label="Export another file"
          buttonClass="button filled big"
          align="right"
          items={[
            ...outputs.map((output) => {
              const kept = result.outputs[output.name];
              return {
                label: output.label,
                hint: kept ? formatBytes(kept.bytes) : undefined,
                disabledReason: busy,
                onSelect: () => void saveOutput(session, output),
              };
            }),
            howMadeItem(session.title, null, result),
          ]}
        >
          <Icon name="chevronDown" small />
        </Menu>
      </div>
      <p>
        {figure(report, 'pillar_count')} pillars. {closed}
        {volume === null ? '' : `, ${withUnit(formatFixed(volume, 0), 'ml')}`}
      </p>
    </>
  );
}
