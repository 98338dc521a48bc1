// SPDX-License-Identifier: GPL-3.0-or-later
// Earlier results in the strip, each with what it was made with and the one figure that tells it apart.
import { useEffect, useState } from 'preact/hooks';
import type { Json } from '../../jobs/contract';
import type { BlobReference } from '../../project/document';
import { jsonEqual } from '../../project/document';
import { formatFixed, Icon, Menu, withUnit } from '../../ui';
import type { CraftResult, RoomDocument } from '../session/craft_document';
import { inForce } from '../session/craft_document';
import type { RoomSession } from '../session/room_session';

const shownResults = 3;

export interface ResultsProps<D extends RoomDocument> {
  readonly session: RoomSession<D>;
  readonly current: CraftResult | null;
  /** Told by this where the results have all parameters in common. */
  readonly usualParameter: string;
  /** What is said beside it: "normal error 11.1°", and the short of it. */
  readonly figureOf: (result: CraftResult) => { readonly short: string; readonly spoken: string };
  readonly onChoose: (result: CraftResult, label: string) => void;
  /** Which may be returned to; left out: those made from what is open. */
  readonly results?: readonly CraftResult[];
  /** Left out: the parameter that tells them apart. */
  readonly nameOf?: (result: CraftResult) => string;
}

export function Results<D extends RoomDocument>(props: ResultsProps<D>) {
  const { session, current, figureOf } = props;
  const { results } = session.document.value;
  if (session.operation.value === null || results.length === 0) return null;
  const ours = props.results ?? results.filter((result) => result.mesh === session.subject.value?.key);
  if (ours.length === 0) return null;
  const telling = tellingParameter(ours, props);
  const name = props.nameOf ?? ((result: CraftResult) => describe(result, telling, session));
  const choose = (result: CraftResult) => props.onChoose(result, `Return to ${name(result)}`);
  return (
    <div class="results">
      <ul aria-label="Earlier results">
        {ours.slice(0, shownResults).map((result) => (
          <li key={result.id}>
            <button
              type="button"
              class="result"
              aria-current={result.id === current?.id ? 'true' : undefined}
              aria-label={`${name(result)}, ${figureOf(result).spoken}`}
              onClick={() => choose(result)}
            >
              <Picture session={session} reference={result.picture} />
              {name(result)}
              <em>{figureOf(result).short}</em>
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
            label: name(result),
            hint: figureOf(result).short,
            onSelect: () => choose(result),
          })),
          ...(ours.length > shownResults ? [null] : []),
          {
            label: 'Delete this result',
            icon: 'trash' as const,
            disabledReason: current ? undefined : 'Choose a result first',
            onSelect: () => {
              if (current) session.services.projects.do(session.commands.removeResult(current.id));
            },
          },
        ]}
      >
        <Icon name="more" />
      </Menu>
    </div>
  );
}

/** The first number by which these results differ. */
function tellingParameter<D extends RoomDocument>(
  results: readonly CraftResult[],
  { session, usualParameter }: ResultsProps<D>,
): string {
  const operation = session.operation.value;
  const names = Object.keys(operation?.parameters.properties ?? {});
  const value = (result: CraftResult, name: string): Json =>
    operation ? inForce(operation, result.parameters, name) : null;
  const first = results[0];
  const differs = (name: string) =>
    first !== undefined &&
    results.every((result) => typeof value(result, name) === 'number') &&
    results.some((result) => !jsonEqual(value(result, name), value(first, name)));
  return names.find(differs) ?? usualParameter;
}

function describe<D extends RoomDocument>(
  result: CraftResult,
  name: string,
  session: RoomSession<D>,
): string {
  const operation = session.operation.value;
  const value = operation ? inForce(operation, result.parameters, name) : null;
  const unit = operation?.parameters.properties[name]?.['x-unit'] ?? '';
  return typeof value === 'number' ? withUnit(formatFixed(value, value < 100 ? 1 : 0), unit) : '–';
}

function Picture<D extends RoomDocument>({
  session,
  reference,
}: {
  session: RoomSession<D>;
  reference: BlobReference | undefined;
}) {
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
