// SPDX-License-Identifier: GPL-3.0-or-later
// The shell: top bar, rail, the page of the current place, and what belongs to all of them.
import { signal, useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import type { PrintDialog as PrintDialogComponent } from '../shared/print/print_dialog';
import { toPrint, toSlice } from '../shared/print/print_request';
import { solveInFull } from '../shared/session/full_solve';
import type { Services } from '../shared/session/services';
import type { SliceDialog as SliceDialogComponent } from '../shared/print/slice_dialog';
import type { EvidencePage as EvidencePageComponent } from '../crafts/evidence/evidence_page';
import type { MachinesPage as MachinesPageComponent } from '../crafts/machines/machines_page';
import type { ReliefPage as ReliefPageComponent } from '../crafts/relief/relief_page';
import type { ThermoformPage as ThermoformPageComponent } from '../crafts/thermoform/thermoform_page';
import type { ZippablePage as ZippablePageComponent } from '../crafts/zippable/zippable_page';
import { projectExtension } from '../project/archive';
import { Icon, TipLayer, toast, ToastLayer } from '../ui';
import { AboutPage } from './about_page';
import { ChooseCraft, evidenceEndings, roomFor } from './choose_craft';
import { crafts } from './crafts';
import { KeysDialog, WorkerDialog } from './shell/dialogs';
import { droppedFiles } from './dropped_files';
import { Rail } from './shell/rail';
import { showLearnCard } from './learn/learn_card';
import { LearnDialog } from './learn/learn_list';
import { watchPage } from './learn/learning';
import { go, place } from './route';
import { formatNames, StartPage } from './start_page';
import type { Room, Sessions } from './rooms';
import { MachineBar } from '../crafts/machines/panel/machine_bar';
import { drawingEndings, heightMapEnding, jobEndings } from '../crafts/machines/machines_document';
import { flatView } from '../crafts/zippable/views';
import { isRoom, placeOfWork, roomOf } from './rooms';
import { sentenceOf } from './failure_toast';
import { TopBar } from './shell/top_bar';

/** Materials and pictures that may come with a model. */
const companionEndings = ['.mtl', '.png', '.jpg', '.jpeg'];

/** The viewport is most of the program; it comes when a place needs it, or when the start screen is at rest. */
const reliefPage = signal<{ readonly Page: typeof ReliefPageComponent } | null>(null);
const loadReliefPage = () =>
  import('../crafts/relief/relief_page').then(({ ReliefPage }) => (reliefPage.value = { Page: ReliefPage }));
const thermoformPage = signal<{ readonly Page: typeof ThermoformPageComponent } | null>(null);
const loadThermoformPage = () =>
  import('../crafts/thermoform/thermoform_page').then(
    ({ ThermoformPage }) => (thermoformPage.value = { Page: ThermoformPage }),
  );
const zippablePage = signal<{ readonly Page: typeof ZippablePageComponent } | null>(null);
const loadZippablePage = () =>
  import('../crafts/zippable/zippable_page').then(
    ({ ZippablePage }) => (zippablePage.value = { Page: ZippablePage }),
  );

const evidencePage = signal<{ readonly Page: typeof EvidencePageComponent } | null>(null);
const loadEvidencePage = () =>
  import('../crafts/evidence/evidence_page').then(
    ({ EvidencePage }) => (evidencePage.value = { Page: EvidencePage }),
  );

const machinesPage = signal<{ readonly Page: typeof MachinesPageComponent } | null>(null);
const loadMachinesPage = () =>
  import('../crafts/machines/machines_page').then(
    ({ MachinesPage }) => (machinesPage.value = { Page: MachinesPage }),
  );

const printDialogs = signal<{
  readonly Print: typeof PrintDialogComponent;
  readonly Slice: typeof SliceDialogComponent;
} | null>(null);
const loadPrintDialogs = () =>
  Promise.all([import('../shared/print/print_dialog'), import('../shared/print/slice_dialog')]).then(
    ([{ PrintDialog }, { SliceDialog }]) => (printDialogs.value = { Print: PrintDialog, Slice: SliceDialog }),
  );

export interface AppProps {
  readonly services: Services;
  readonly sessions: Sessions;
}

export function App({ services, sessions }: AppProps) {
  const dialog = useSignal<'keys' | 'worker' | 'learn' | null>(null);
  const dropping = useSignal(false);
  const choosing = useSignal<readonly File[] | null>(null);
  const input = useRef<HTMLInputElement>(null);
  const chooseFile = () => input.current?.click();

  const openFiles = async (files: readonly File[]) => {
    const project = files.find(({ name }) => name.toLowerCase().endsWith(`.${projectExtension}`));
    if (project) {
      try {
        await services.projects.importFile(new Uint8Array(await project.arrayBuffer()));
        go(placeOfWork(services.projects.document.value) ?? 'relief');
        toast(`Opened ${services.projects.document.value.name}.`);
      } catch (thrown) {
        const message = sentenceOf(thrown);
        const where = roomOf(place.value);
        sessions[where].problem.value = { kind: 'file', title: `Could not open ${project.name}`, message };
        go(where);
      }
      return;
    }
    if (files.length === 0) return;
    // Until the solver has started nothing is known of formats; without one the room says so.
    const catalog = services.catalog.value ?? (await services.browser.catalog().catch(() => null));
    const room = sessions.relief.forest.takes(files) ? 'relief' : roomFor(files, place.value, catalog);
    if (room === null) choosing.value = files;
    else await openIn(room, files);
  };
  const openIn = async (room: Room, files: readonly File[]) => {
    try {
      if (place.value === 'start' && !services.projects.isBlank.value) await services.projects.create();
    } catch (thrown) {
      toast(sentenceOf(thrown), true); // what is open could not be saved, and stays
      return;
    }
    if (place.value === 'start') sessions.relief.forest.show(false);
    go(room);
    await sessions[room].openFiles(files);
  };

  useFileDrop(dropping, openFiles);
  useGlobalKeys(services, { chooseFile, showKeys: () => (dialog.value = 'keys') });
  useLaunchedFiles(openFiles);
  useEffect(() => {
    const ends = [watchPage(services.projects), showLearnCard()];
    return () => ends.forEach((end) => end());
  }, []);

  const where = place.value;
  const ReliefPage = reliefPage.value?.Page;
  const ThermoformPage = thermoformPage.value?.Page;
  const ZippablePage = zippablePage.value?.Page;
  const EvidencePage = evidencePage.value?.Page;
  const MachinesPage = machinesPage.value?.Page;
  useEffect(() => {
    if (where === 'relief') void loadReliefPage();
    if (where === 'thermoform') void loadThermoformPage();
    if (where === 'zippable') void loadZippablePage();
    if (where === 'evidence') void loadEvidencePage();
    if (where === 'machines') void loadMachinesPage();
  }, [where]);
  const dialogWanted = toPrint.value !== null || toSlice.value !== null;
  useEffect(() => {
    if (dialogWanted) void loadPrintDialogs();
  }, [dialogWanted]);
  const Dialogs = printDialogs.value;
  const session = isRoom(where) ? sessions[where] : null;
  const hasInspector = session !== null && session.hasWork.value;
  const hasStrip = hasInspector || session?.activity.value.kind === 'opening';
  const solving = [...Object.values(sessions), sessions.relief.forest].some(
    ({ activity }) => activity.value.kind === 'solving',
  );
  return (
    <div class={`app ${hasInspector ? 'with-side' : ''} ${hasStrip ? 'with-strip' : ''}`}>
      <TopBar
        services={services}
        solving={solving}
        onOpenFile={chooseFile}
        onKeys={() => (dialog.value = 'keys')}
        onWorker={() => (dialog.value = 'worker')}
        onLearn={() => (dialog.value = 'learn')}
      />
      <Rail />
      {where === 'relief' && ReliefPage ? (
        <ReliefPage
          session={sessions.relief}
          onChooseFile={chooseFile}
          onWorkerHelp={() => (dialog.value = 'worker')}
          onSendToMill={async (name, heightMap, size) => {
            const taken = await sessions.machines.take(name, heightMap, 'model', size);
            if (taken || sessions.machines.problem.value !== null) go('machines');
            if (taken) void solveInFull(sessions.machines); // sending it asks for its job
          }}
        />
      ) : where === 'thermoform' && ThermoformPage ? (
        <ThermoformPage session={sessions.thermoform} onChooseFile={chooseFile} />
      ) : where === 'zippable' && ZippablePage ? (
        <ZippablePage
          session={sessions.zippable}
          onChooseFile={chooseFile}
          onSendToMachine={async (name, drawing) => {
            const taken = await sessions.machines.take(name, drawing, 'drawing', {}, { of_plan: true });
            if (taken || sessions.machines.problem.value !== null) go('machines');
          }}
        />
      ) : where === 'evidence' && EvidencePage ? (
        <EvidencePage session={sessions.evidence} onChooseFile={chooseFile} />
      ) : where === 'machines' && MachinesPage ? (
        <MachinesPage
          session={sessions.machines}
          onChooseFile={chooseFile}
          onLayOutAgain={(bed_mm) => {
            sessions.zippable.sheets.useBed(bed_mm);
            flatView.value = 'sheets';
            go('zippable');
          }}
        />
      ) : isRoom(where) ? (
        <main
          class="view"
          aria-label={crafts.find((craft) => craft.place === where)?.title}
          aria-busy="true"
        />
      ) : where === 'about' ? (
        <AboutPage services={services} />
      ) : (
        <StartPage services={services} session={sessions.relief} onChooseFile={chooseFile} />
      )}
      {dropping.value ? (
        <div class="drop-target" aria-hidden="true">
          <div>
            <Icon name="upload" />
            <h2>Drop to open</h2>
            <p>
              {where === 'evidence'
                ? 'Measured objects: mould.obj, setup.json, measured.csv, their folder or zip'
                : where === 'machines'
                  ? `Drawings and jobs: ${[...drawingEndings, ...jobEndings].join(', ')}. For mills, models and height maps: ${heightMapEnding}`
                  : `Models: ${formatNames(services)}`}
              . Projects: .{projectExtension}.
            </p>
            {services.projects.isBlank.value ? null : <p>Your project is saved first.</p>}
          </div>
        </div>
      ) : null}
      <input
        ref={input}
        type="file"
        hidden
        multiple
        aria-label="Model or project file"
        accept={[
          ...(services.catalog.value?.mesh_formats ?? []).map((f) => `.${f.extension}`),
          ...companionEndings,
          ...(where === 'evidence' || where === 'start' ? evidenceEndings : []),
          ...(where === 'machines' || where === 'start' ? [...drawingEndings, ...jobEndings] : []),
          `.${projectExtension}`,
        ].join()}
        onChange={(event) => {
          const files = [...(event.currentTarget.files ?? [])];
          event.currentTarget.value = '';
          if (files.length > 0) void openFiles(files);
        }}
      />
      {choosing.value ? (
        <ChooseCraft
          files={choosing.value}
          catalog={services.catalog.value}
          onClose={() => (choosing.value = null)}
          onChoose={(room) => {
            const files = choosing.value ?? [];
            choosing.value = null;
            void openIn(room, files);
          }}
        />
      ) : null}
      {dialog.value === 'keys' ? <KeysDialog onClose={() => (dialog.value = null)} /> : null}
      {dialog.value === 'learn' ? (
        <LearnDialog projects={services.projects} onClose={() => (dialog.value = null)} />
      ) : null}
      {dialog.value === 'worker' ? (
        <WorkerDialog services={services} onClose={() => (dialog.value = null)} />
      ) : null}
      {Dialogs && toPrint.value ? (
        <Dialogs.Print services={services} printable={toPrint.value} onClose={() => (toPrint.value = null)} />
      ) : null}
      {Dialogs && toSlice.value ? (
        <Dialogs.Slice services={services} solid={toSlice.value} onClose={() => (toSlice.value = null)} />
      ) : null}
      {where === 'machines' ? null : <MachineBar session={sessions.machines} />}
      <ToastLayer />
      <TipLayer />
    </div>
  );
}

function useFileDrop(
  dropping: { value: boolean },
  openFiles: (files: readonly File[]) => Promise<void>,
): void {
  useEffect(() => {
    let depth = 0; // dragenter and dragleave come for every element that is crossed
    const hasFiles = (event: DragEvent) => event.dataTransfer?.types.includes('Files') === true;
    const enter = (event: DragEvent) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      ++depth;
      dropping.value = true;
    };
    const over = (event: DragEvent) => {
      if (hasFiles(event)) event.preventDefault();
    };
    const leave = () => {
      depth = Math.max(0, depth - 1);
      if (depth === 0) dropping.value = false;
    };
    const drop = (event: DragEvent) => {
      depth = 0;
      dropping.value = false;
      if (!hasFiles(event) || event.dataTransfer === null) return;
      event.preventDefault();
      void droppedFiles(event.dataTransfer).then(openFiles);
    };
    const handlers = { dragenter: enter, dragover: over, dragleave: leave, drop } as const;
    for (const [name, handler] of Object.entries(handlers))
      document.addEventListener(name, handler as EventListener);
    return () => {
      for (const [name, handler] of Object.entries(handlers))
        document.removeEventListener(name, handler as EventListener);
    };
  }, []);
}

function useGlobalKeys(services: Services, actions: { chooseFile: () => void; showKeys: () => void }): void {
  useEffect(() => {
    const onKey = (event: KeyboardEvent) => {
      if (event.defaultPrevented || document.querySelector('dialog[open]')) return;
      const control = event.ctrlKey || event.metaKey;
      const typing = (event.target as Element).matches('input[type=text], textarea, select');
      const key = event.key.toLowerCase();
      const act = (action: () => void) => {
        event.preventDefault();
        action();
      };
      if (control && key === 'o') act(actions.chooseFile);
      else if (typing && control)
        return; // a text field undoes its own typing
      else if (control && key === 'z')
        act(() => (event.shiftKey ? services.projects.redo() : services.projects.undo()));
      else if (control && key === 'y') act(() => services.projects.redo());
      else if (typing || control || event.altKey) return;
      else if (key === '?') act(actions.showKeys);
      else if (/^[1-5]$/.test(key)) {
        const craft = crafts[Number(key) - 1];
        if (craft) act(() => go(craft.place));
      }
    };
    document.addEventListener('keydown', onKey);
    return () => document.removeEventListener('keydown', onKey);
  }, []);
}

interface LaunchQueue {
  setConsumer(consumer: (launch: { files: readonly { getFile(): Promise<File> }[] }) => void): void;
}

/** Files opened with the installed app from the system's file manager. */
function useLaunchedFiles(openFiles: (files: readonly File[]) => Promise<void>): void {
  useEffect(() => {
    const { launchQueue } = window as { launchQueue?: LaunchQueue };
    launchQueue?.setConsumer(({ files }) => {
      void Promise.all(files.map((file) => file.getFile())).then(openFiles);
    });
  }, []);
}
