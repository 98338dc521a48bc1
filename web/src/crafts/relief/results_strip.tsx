// SPDX-License-Identifier: GPL-3.0-or-later
import { useEffect, useState } from 'preact/hooks';
import type { Json } from '../../jobs/contract';
import type { BlobReference } from '../../project/document';
import { jsonEqual } from '../../project/document';
import {
  formatCount,
  formatDuration,
  formatFixed,
  Icon,
  JobStrip,
  Menu,
  useLasting,
  withUnit,
} from '../../ui';
import type { ReliefResult } from './relief_document';
import { inForce, removeResult, restoreResult } from './relief_document';
import type { ReliefSession } from './relief_session';
import { figure, solvedLine } from './report';

const shownResults = 3;

export function ResultsStrip({ session }: { session: ReliefSession }) {
  const activity = session.activity.value;
  const lasting = useLasting(activity.kind !== 'idle');
  const result = session.result.value;
  if (lasting && activity.kind !== 'idle') {
    const titles = {
      solving: 'Solving the relief',
      opening: 'Opening the model',
      exporting: 'Making the file',
    };
    return (
      <JobStrip
        state="running"
        title={titles[activity.kind]}
        detail={activity.progress?.stage ?? (activity.kind === 'opening' ? activity.name : 'Starting')}
        progress={activity.progress ?? { fraction: 0, seconds_left: null }}
        onCancel={() => session.cancel()}
      />
    );
  }
  const state = result
    ? { state: 'done' as const, title: 'Relief ready', detail: solvedLine(result.seconds, result.report) }
    : previewLine(session);
  return (
    <JobStrip {...state}>
      <Results session={session} />
    </JobStrip>
  );
}

function previewLine(session: ReliefSession) {
  const shown = session.shown.value;
  const errors = Object.values(session.fieldErrors.value);
  if (errors[0]) return { state: 'attention' as const, title: 'Not solved', detail: errors[0] };
  if (shown === null)
    return { state: 'idle' as const, title: 'No relief yet', detail: 'The preview comes first' };
  const seconds = session.previewSeconds.value;
  const triangles = `${formatCount(shown.mesh.indices.length / 3)} triangles`;
  return {
    state: 'idle' as const,
    title: session.previewing.value ? 'Preview' : 'Preview up to date',
    detail: seconds === null ? triangles : `${triangles}, ${formatDuration(seconds)} in the browser`,
  };
}

function Results({ session }: { session: ReliefSession }) {
  const { results, model } = session.document.value;
  const operation = session.operation.value;
  if (operation === null || results.length === 0) return null;
  const ours = results.filter((result) => result.mesh === model?.mesh.blob);
  const telling = tellingParameter(ours, session);
  const current = session.result.value;
  const choose = (result: ReliefResult) =>
    session.services.projects.do(restoreResult(result, `Return to ${describe(result, telling, session)}`));
  return (
    <div class="results">
      <ul aria-label="Earlier results">
        {ours.slice(0, shownResults).map((result) => (
          <li key={result.id}>
            <button
              type="button"
              class="result"
              aria-current={result.id === current?.id ? 'true' : undefined}
              aria-label={`${describe(result, telling, session)}, normal error ${errorText(result)}`}
              onClick={() => choose(result)}
            >
              <Picture session={session} reference={result.picture} />
              {describe(result, telling, session)}
              <em>{errorText(result)}</em>
            </button>
          </li>
        ))}
      </ul>
      <Menu
        label="More about the results"
        buttonClass="icon-button"
        align="right"
        items={[
          ...ours.slice(shownResults).map((result) => ({
            label: describe(result, telling, session),
            hint: errorText(result),
            onSelect: () => choose(result),
          })),
          ...(ours.length > shownResults ? [null] : []),
          {
            label: 'Delete this result',
            icon: 'trash' as const,
            disabledReason: current ? undefined : 'None chosen',
            onSelect: () => {
              if (current) session.services.projects.do(removeResult(current.id));
            },
          },
        ]}
      >
        <Icon name="more" />
      </Menu>
    </div>
  );
}

/** The first number by which these results differ; the thickness where they do not. */
function tellingParameter(results: readonly ReliefResult[], session: ReliefSession): string {
  const operation = session.operation.value;
  const names = Object.keys(operation?.parameters.properties ?? {});
  const value = (result: ReliefResult, name: string): Json =>
    operation ? inForce(operation, result.parameters, name) : null;
  const first = results[0];
  const differs = (name: string) =>
    first !== undefined &&
    typeof value(first, name) === 'number' &&
    results.some((result) => !jsonEqual(value(result, name), value(first, name)));
  return names.find(differs) ?? 'thickness_mm';
}

function describe(result: ReliefResult, name: string, session: ReliefSession): string {
  const operation = session.operation.value;
  const value = operation ? inForce(operation, result.parameters, name) : null;
  const unit = operation?.parameters.properties[name]?.['x-unit'] ?? '';
  return typeof value === 'number' ? withUnit(formatFixed(value, value < 100 ? 1 : 0), unit) : '–';
}

function errorText(result: ReliefResult): string {
  const error = figure(result.report, 'normal_error_mean_deg');
  return error === null ? '' : `${formatFixed(error, 1)}°`;
}

function Picture({ session, reference }: { session: ReliefSession; reference: BlobReference | undefined }) {
  const [url, setUrl] = useState<string | null>(null);
  const hash = reference?.blob;
  useEffect(() => {
    let made: string | null = null;
    let gone = false;
    if (reference)
      session.services.projects.blobs.read(reference.blob).then(
        (bytes) => {
          if (gone) return;
          made = URL.createObjectURL(new Blob([bytes], { type: reference.media_type }));
          setUrl(made);
        },
        () => undefined,
      );
    return () => {
      gone = true;
      if (made) URL.revokeObjectURL(made);
    };
  }, [hash]);
  return url ? <img src={url} alt="" /> : <i />;
}
