!> One job: deck in, listing out. Sets are independent of one another, and long jobs compute them in several processes.
module job
   use, intrinsic :: iso_fortran_env, only: int64
   use, intrinsic :: iso_c_binding, only: c_int
   use failures, only: failure_t, fail, status_rejected, status_solved, status_flagged, status_signal
   use mechanism, only: mechanism_t, instant_count, instant, with_all_links
   use structure, only: structure_report_t, check_structure, find_groups
   use deck, only: read_deck
   use system_calls, only: watch_signals, signal_received, write_bytes
   use text_output, only: flush_output, turn_lost
   use processes, only: processor_count, end_process
   use command_line

   use outputs, only: open_outputs, open_table, close_outputs, is_over
   use job_chunks, only: run_chunks, next_part
   use writers, only: writers_t, break_off
   use motion_run, only: run_motion
   use variant_runs, only: run_variants, are_together
   use lane_runs, only: lane_count

   use listing, only: new_layout, listing_head, remark_text
   use csv, only: csv_head, new_table, table_head
   use solver_log, only: log_head
   use drawing, only: drawing_t, film_of, new_drawing, record_instant
   use svg, only: page_t, begin_page, end_page
   use dxf, only: point_path_t, new_paths, extend_paths, begin_dxf, write_dxf, end_dxf
   use picture, only: draw_picture
   use animation, only: draw_animation
   use circuits, only: circuits_t
   use set_circuits, only: find_all_circuits
   use circuits_picture, only: draw_circuits
   use answers, only: answers_t
   use counts, only: counts_t
   use phrases, only: text_broken_set, text_broken_variant
   use set_motion, only: new_set_motion
   use set_analysis, only: set_analysis_t, make_set_analysis, advance_set
   implicit none
   private
   public :: run_job

   !> Links times instants from which on more than one process is made: about a hundredth of a second.
   real, parameter :: least_work = 2.0e4

contains

   !> Runs a job: reads the deck, computes its sets and writes the outputs. On an error, status and message are those of
   !> the error. A child process does not return: it ends here.
   subroutine run_job(options, status, message)
      type(options_t), intent(in) :: options   !< of the command
      integer, intent(out) :: status         !< exit status: the largest of all sets, or the status of the error
      character(:), allocatable, intent(out) :: message   !< lines for standard error; '': none
      ! Kept: the system takes back the memory of thousands of sets in a part of the time that freeing each would take.
      type(mechanism_t), allocatable, save :: sets(:)
      type(structure_report_t), allocatable, save :: structure_report(:)
      type(failure_t), allocatable :: failure
      type(writers_t) :: o
      integer :: i, processes, count_sets

      status = status_solved
      o%options = options
      call read_deck(options%deck, sets, message, failure, o%variations)
      if (.not. allocated(failure)) call check_options(options, sets, failure)
      if (.not. allocated(failure)) then
         count_sets = size(sets)
         call choose_share(sets, o)
         if (o%last - o%first + 1 < count_sets) sets = sets(o%first:o%last)
         if (allocated(options%files(out_circuits)%text) .and. .not. any(sets%circuits)) call fail(failure, &
            status_rejected, 'OPTION --circuits NEEDS A SET WITH A CIRCUITS CARD')
      end if
      if (.not. allocated(failure)) call check_structure(sets, structure_report, failure)
      if (allocated(failure) .and. len(message) == 0) message = remarks_text()//' *** '//failure%text
      if (.not. allocated(failure)) call open_outputs(options, o%first, o%last, count_sets, o, failure)

      if (.not. allocated(failure)) then
         call watch_signals
         if (any([(are_together(sets(i), any(sets(i)%requests%every > 0 .or. sets(i)%requests%drive > 0), o), &
            i=1, size(sets))])) o%share%unit = lane_count
         processes = process_count(sets, o)
         if (processes > 1) call run_chunks(o, processes, status, message)
         do while (next_part(o))
            call run_sets(sets, structure_report, o)
         end do
         call close_outputs(o, 1, out_shared)
         if (allocated(o%failure)) call move_alloc(o%failure, failure)
         status = max(status, o%status)
      end if

      if (allocated(failure)) then
         status = failure%status
         if (len(message) == 0) message = ' *** '//failure%text
      else if (len(message) == 0 .and. .not. (o%asked(out_listing) .or. o%share%is_child)) then
         message = remarks_text()
         ! The end of the last line comes with the message.
         message = message(:max(0, len(message) - 1))
      end if
      ! A run that a signal has ended ends by that signal.
      if (signal_received() > 0) status = status_signal + signal_received()
      if (.not. o%share%is_child) return
      ! A child ends here: its parent takes over the status, unless its turn has never come.
      if (any(o%files%error == turn_lost)) call end_process(status_solved)
      if (len(message) > 0) i = int(write_bytes(2_c_int, message//new_line('a')))
      call end_process(status)

   contains

      !> Gives the remarks about `sets`, each line ended by new_line('a'); '' for --quiet.
      function remarks_text() result(text)
         character(:), allocatable :: text
         integer :: k

         text = ''
         if (options%quiet) return
         do i = 1, size(sets)
            if (.not. allocated(sets(i)%remarks)) cycle
            do k = 1, size(sets(i)%remarks)
               text = text//' --- '//remark_text(sets(i), sets(i)%remarks(k))//new_line('a')
            end do
         end do
      end function remarks_text
   end subroutine run_job

   !> Checks the options against the sets of the deck. Errors: status_rejected. A deck with VARY cards has no table,
   !> which has columns for one motion, and no picture of a part of its sets. The number of its variants is limited.
   subroutine check_options(options, sets, failure)
      type(options_t), intent(in) :: options   !< of the command
      type(mechanism_t), intent(in) :: sets(:)   !< (sets of the deck)
      type(failure_t), allocatable, intent(out) :: failure   !< not allocated: the options fit

      if (.not. any(sets%variants > 0)) return
      ! The numbers of variants must be whole numbers of the default kind.
      if (variant_count(sets) > huge(1)) call fail(failure, status_rejected, &
         'TOO MANY VARIANTS IN ALL SETS: DIVIDE THE DECK')
      if (options%shares > 1 .and. (allocated(options%files(out_svg)%text) .or. &
         allocated(options%files(out_animation)%text))) call fail(failure, status_rejected, &
         'PICTURES OF A DECK WITH VARY CARDS CANNOT BE DIVIDED: OMIT --sets')
      if (allocated(options%files(out_table)%text)) call fail(failure, status_rejected, &
         'OPTION --table TAKES NO DECK WITH VARY CARDS: USE --summary OR --csv')
   end subroutine check_options

   !> Counts the variants of all sets. A set without VARY cards counts as one.
   pure integer(int64) function variant_count(sets)
      type(mechanism_t), intent(in) :: sets(:)   !< (sets of the deck)

      variant_count = sum(int(max(1, sets%variants), int64))
   end function variant_count

   !> Finds which sets this command computes by its option --sets. If the deck has VARY cards, it finds which variants.
   subroutine choose_share(sets, writers)
      type(mechanism_t), intent(in) :: sets(:)   !< (sets of the deck)
      type(writers_t), intent(inout) :: writers   !< with the options; get the share and the sets

      writers%varies = any(sets%variants > 0)
      writers%share%kind = trim(merge('VARIANTS', 'SETS    ', writers%varies))
      associate (all => variant_count(sets), k => writers%options%share, n => writers%options%shares)
         writers%share%first = int(all*(k - 1)/n) + 1
         writers%share%last = int(all*k/n)
      end associate
      writers%first = merge(1, writers%share%first, writers%varies)
      writers%last = merge(size(sets), writers%share%last, writers%varies)
   end subroutine choose_share

   !> Gives the number of processes that compute the sets. The number is 1 if the sets take no time or are drawn on one
   !> page, or if no output can be written.
   integer function process_count(sets, writers)
      type(mechanism_t), intent(in) :: sets(:)   !< (sets of the share)
      type(writers_t), intent(in) :: writers   !< with the options; open
      real :: work
      integer :: i

      process_count = writers%options%jobs
      work = sum([(real(instant_count(sets(i)))*max(1, sets(i)%variants)*size(sets(i)%links), i=1, size(sets))])
      if (process_count == 0) process_count = merge(processor_count(), 1, work > least_work)
      if (writers%options%check .or. any(writers%asked([out_svg, out_animation, out_circuits, out_dxf])) &
         .or. any(writers%files%error /= 0)) &
         process_count = 1
      process_count = min(process_count, sum(max(1, sets%variants)))
   end function process_count

   !> Computes and writes the sets of the current part, one after another. The texts of all parts in their order are the
   !> text of the whole. After a signal or a failed output no further set is computed.
   subroutine run_sets(sets, structure_report, writers)
      type(writers_t), intent(inout) :: writers   !< open, with the current part
      type(mechanism_t), intent(inout) :: sets(writers%first:)   !< (sets of the share) lose their cards
      type(structure_report_t), intent(inout) :: structure_report(writers%first:)   !< (sets of the share) are used up
      type(page_t), target :: pages(out_svg:out_circuits)
      type(set_analysis_t) :: a
      type(circuits_t), allocatable :: found(:)
      integer :: i, k, before

      if (writers%asked(out_csv) .and. writers%options%share == 1 .and. writers%own_first == 1) &
         call csv_head(writers%files(out_csv), writers%options%errors, writers%varies)
      do k = out_svg, out_circuits
         if (writers%asked(k)) call begin_page(writers%files(k), pages(k))
      end do
      if (writers%asked(out_dxf)) call begin_dxf(writers%files(out_dxf))

      before = writers%first - 1
      ! If no set has variants, those before the current part need not be counted.
      if (.not. writers%varies) before = writers%own_first - 1
      do i = before + 1, writers%last
         if (before >= writers%own_last) exit
         associate (count => max(1, sets(i)%variants))
            if (before < writers%own_last .and. before + count >= writers%own_first) &
               call run_set(sets(i), i, writers%own_first - before, writers%own_last - before, structure_report(i), &
                  writers)
            before = before + count
         end associate
         if (is_over(writers)) then
            if (before > writers%own_last) then
               call break_off(writers, sets(i), text_broken_variant, writers%own_last - before + sets(i)%variants)
            else if (i < writers%last) then
               call break_off(writers, sets(i), text_broken_set, sets(i)%set_number)
            end if
            exit
         end if
         ! Sets that were broken off are not drawn.
         if (writers%asked(out_svg) .or. writers%asked(out_animation)) call draw_set(sets(i), size(sets), writers, &
            pages)
         if (writers%asked(out_dxf)) call export_set(sets(i), i - writers%first + 1, writers)
         if (writers%asked(out_circuits) .and. sets(i)%circuits) then
            ! Circuits have an analysis of their own, like a picture.
            call make_set_analysis(sets(i), a)
            call advance_set(a, instant(sets(i), 0))
            call find_all_circuits(a, found)
            call draw_circuits(pages(out_circuits), sets(i), a%now, found)
         end if
      end do

      do k = out_svg, out_circuits
         if (writers%asked(k)) call end_page(writers%files(k), pages(k))
      end do
      if (writers%asked(out_dxf)) call end_dxf(writers%files(out_dxf))
   end subroutine run_sets

   !> Draws the motion of a set on the pages that are asked for. If a signal comes, nothing is drawn. The motion has an
   !> analysis of its own: a picture shows links that no table asks for, and printed numbers must not depend on it.
   subroutine draw_set(m, sets, writers, pages)
      type(mechanism_t), intent(in) :: m     !< the set
      integer, intent(in) :: sets            !< number of sets that are drawn
      type(writers_t), intent(inout) :: writers   !< with the options; get the pages
      type(page_t), intent(inout), target :: pages(out_svg:)   !< (svg, animation, ...) begun
      type(mechanism_t) :: film
      type(drawing_t), target :: d
      type(set_analysis_t) :: a
      integer :: every, k

      call film_of(m, sets, film, every)
      d = new_drawing(film, every, writers%options%arrows, .not. writers%options%no_centrodes)
      call make_set_analysis(with_all_links(film), a)
      do k = 0, instant_count(film) - 1
         ! The first of the instants of AT, from which the deck's own motion goes on.
         if (every == 0 .and. k == film%steps + 1) call make_set_analysis(with_all_links(m), a)
         call advance_set(a, instant(film, k))
         call record_instant(d, a%now, k)
         if (signal_received() > 0) return
      end do
      if (writers%asked(out_svg)) call draw_picture(pages(out_svg), d)
      if (writers%asked(out_animation)) call draw_animation(pages(out_animation), d)
   end subroutine draw_set

   !> Exports the motion of a set at the instants of the deck to the file for CAD. If a signal comes, nothing is
   !> written. The export has an analysis of its own: it shows links that no table asks for.
   subroutine export_set(m, i, writers)
      type(mechanism_t), intent(in) :: m     !< the set
      integer, intent(in) :: i               !< the number of the set in the file, from 1
      type(writers_t), intent(inout) :: writers   !< with the file, begun
      type(set_analysis_t) :: a
      type(drawing_t) :: d
      type(point_path_t), allocatable :: paths(:)
      integer :: k

      call make_set_analysis(with_all_links(m), a)
      d = new_drawing(m, merge(1, 0, m%steps >= 0), .false., .false.)
      call new_paths(m, paths)
      do k = 0, merge(m%steps, instant_count(m) - 1, m%steps >= 0)
         call advance_set(a, instant(m, k))
         if (k == 0) call record_instant(d, a%now, k)
         call extend_paths(paths, a%now, k)
         if (signal_received() > 0) return
      end do
      call write_dxf(writers%files(out_dxf), d, paths, i)
   end subroutine export_set

   !> Solves and writes a set, or some of its variants. If the file of its table cannot be opened, the run is broken
   !> off.
   subroutine run_set(m, i, first, last, structure_report, writers)
      type(mechanism_t), intent(inout) :: m   !< the set; loses its cards
      integer, intent(in) :: i               !< number of the set in the deck
      integer, intent(in) :: first, last     !< the first and the last variant, which may be below 1 or beyond the count
      type(structure_report_t), intent(inout) :: structure_report   !< of the set, which loses it
      type(writers_t), intent(inout) :: writers   !< with the options; get the text of the set
      type(failure_t), allocatable :: failure
      type(counts_t) :: counts
      type(set_analysis_t) :: a
      type(answers_t) :: asked

      call new_set_motion(m, a%now, structure_report)
      if (writers%asked(out_listing) .and. first <= 1) then
         writers%layout = new_layout(a%now)
         call find_groups(m, structure_report)
         call listing_head(writers%files(out_listing), m, structure_report)
      end if
      ! The echo is as large as the deck, and only the head of the listing has it.
      if (allocated(m%echo)) deallocate (m%echo)
      if (writers%options%check) return

      if (first <= 1) then
         call open_table(writers%options, writers%first, writers%last, i, .false., writers, failure)
         if (allocated(failure)) then
            call move_alloc(failure, writers%failure)
            call break_off(writers, m, text_broken_set, m%set_number - 1)
            return
         end if
         if (writers%asked(out_log) .and. m%variants == 0) call log_head(writers%files(out_log), m)
         if (writers%asked(out_table)) then
            writers%table = new_table(a%now, .false.)
            call table_head(writers%files(out_table), writers%table)
         end if
         ! An output that takes nothing is known before anything is computed.
         call flush_output(writers%files)
      end if

      if (m%variants == 0) then
         call run_motion(a, structure_report, .true., writers, counts, asked)
         if (counts%flagged + counts%unproved > 0) writers%status = status_flagged
         call close_outputs(writers, out_shared + 1, out_last)
      else
         call run_variants(a%now, max(1, first), min(m%variants, last), writers%variations(i), writers)
      end if
   end subroutine run_set
end module job
