!> One job: deck in, listing out. Solve an instant, write an instant; nothing is kept for later. Sets are independent of
!> one another, and long jobs compute them in several processes.
module job
   use, intrinsic :: iso_fortran_env, only: int64
   use failures, only: failure_t, fail, status_rejected, status_solved, status_flagged, status_signal
   use mechanism, only: mechanism_t, instant_count, instant, with_all_links
   use structure, only: findings_t, check_structure, find_groups
   use deck, only: read_deck, job_share_t, variants_before
   use progress, only: progress_t, start_progress, show_progress, end_progress
   use system_calls, only: watch_signals, signal_received, broken_pipe_kills, signal_pipe
   use listing, only: new_layout, listing_head
   use listing_diagnostics, only: remarks_text
   use csv, only: csv_head
   use table, only: new_table, table_head
   use plot_script, only: put_script
   use drawing, only: drawing_t, film_of, new_drawing, record_instant
   use picture_page, only: picture_head
   use picture, only: put_pictures
   use circuits, only: circuits_t
   use circuits_table, only: find_all_circuits
   use circuits_picture, only: diagrams_t, add_to_page, put_circuit_page
   use animation, only: put_animations
   use solver_log, only: log_head
   use answers, only: answers_t
   use assembly_table, only: draw_assemblies
   use variant_rows, only: variant_row_t
   use set_runs, only: writers_t, run_motion, run_variants, are_together, break_off
   use phrases, only: say_broken_set, say_broken_variant
   use lane_runs, only: width
   use numerals, only: whole
   use independent, only: set_t
   use set_motion, only: new_set_motion
   use set_analysis, only: set_analysis_t, make_set_analysis, advance_set
   use command_line, only: options_t, file_options, to_standard_output, out_listing, out_csv, out_log, out_svg, &
      out_animation, out_circuits, out_table, out_plot_table, out_plot_script, out_last
   use shares, only: share_of_job_t, run_shares, next_part, end_share
   use processes, only: processor_count
   use outputs, only: open_outputs, flush_outputs, close_outputs, is_over, is_broken_pipe, set_suffix
   implicit none
   private
   public :: run_job

   !> Links times instants from which on more than one process is made: about a hundredth of a second.
   real, parameter :: least_work = 2.0e4

contains

   !> Does what `options` say. `status`: the exit status; `message`: lines for standard error, '' for none.
   subroutine run_job(options, status, message)
      type(options_t), intent(in) :: options
      integer, intent(out) :: status
      character(:), allocatable, intent(out) :: message
      ! Kept: the system takes back the memory of thousands of sets in a part of the time that freeing each would take.
      type(mechanism_t), allocatable, save :: sets(:)
      type(findings_t), allocatable, save :: findings(:)
      type(failure_t), allocatable :: failure
      type(writers_t) :: o
      type(job_share_t) :: share
      type(share_of_job_t) :: own
      integer :: i

      status = status_solved
      call start_progress(o%progress, .not. options%quiet, any(to_standard_output(options%files)))
      share = job_share_t(options%share, options%shares)
      call read_deck(options%deck, sets, message, failure, share, o%variations)
      o%varies = share%varies
      if (.not. allocated(failure) .and. o%varies) call check_variants(options, sets, failure)
      if (.not. allocated(failure) .and. allocated(options%files(out_circuits)%text)) then
         if (.not. any(sets%circuits)) call fail(failure, status_rejected, &
            'OPTION --circuits NEEDS A SET WITH A CIRCUITS CARD')
      end if
      if (.not. allocated(failure)) call check_structure(sets, findings, failure)
      if (allocated(failure) .and. len(message) == 0) message = said_of(options, sets)//' *** '//failure%text
      if (.not. allocated(failure)) then
         o%first = share%first
         o%last = share%last
         if (o%varies) o%first = 1
         if (o%varies) o%last = size(sets)
         call open_outputs(options, o%first, o%last, share%sets, o, failure)
      end if
      if (.not. allocated(failure)) then
         call watch_signals
         own%kind = trim(merge('VARIANTS', 'SETS    ', o%varies))
         own%first = share%first
         own%last = share%last
         if (any([(are_together(sets(i), any(sets(i)%requests%every > 0), o), i=1, size(sets))])) own%unit = width
         associate (processes => process_count(options, sets))
            if (processes > 1) call run_shares(o, own, processes, o%progress, status, message)
         end associate
         if (own%is_child) o%progress%shown = .false.
         do while (next_part(o, own))
            call run_sets(options, sets, findings, o, status)
         end do
         call end_progress(o%progress)
         call close_outputs(o, failure)
      end if
      if (allocated(failure)) then
         status = failure%status
         if (len(message) == 0) message = ' *** '//failure%text
      else if (len(message) == 0 .and. .not. (o%asked(out_listing) .or. own%is_child)) then
         message = said_of(options, sets)
         ! The end of the last line comes with the message.
         message = message(:max(0, len(message) - 1))
      end if
      call look_at_signals(o, status, message)
      if (own%is_child) call end_share(o, status, message)
   end subroutine run_job

   !> Of a deck with VARY cards there is no table, which has columns for one motion, and no picture of a part.
   !> Their numbers must be whole numbers of the default kind.
   subroutine check_variants(options, sets, failure)
      type(options_t), intent(in) :: options
      type(mechanism_t), intent(in) :: sets(:)
      type(failure_t), allocatable, intent(out) :: failure
      integer :: k

      if (sum(int(max(1, sets%variants), int64)) > huge(1)) call fail(failure, status_rejected, &
         'TOO MANY VARIANTS IN ALL SETS: DIVIDE THE DECK')
      if (options%shares > 1 .and. (allocated(options%files(out_svg)%text) .or. &
         allocated(options%files(out_animation)%text))) call fail(failure, status_rejected, &
         'PICTURES OF A DECK WITH VARY CARDS CANNOT BE DIVIDED: OMIT --sets')
      do k = 1, out_last
         if (file_options(k)%each_set .and. allocated(options%files(k)%text)) call fail(failure, status_rejected, &
            'OPTION '//trim(file_options(k)%word)//' TAKES NO DECK WITH VARY CARDS: USE --summary OR --csv')
      end do
   end subroutine check_variants

   !> How many processes compute `sets`: one where they take no time, or are to be drawn on one page.
   integer function process_count(options, sets) result(n)
      type(options_t), intent(in) :: options
      type(mechanism_t), intent(in) :: sets(:)
      real :: work
      integer :: i

      n = options%jobs
      work = sum([(real(instant_count(sets(i)))*max(1, sets(i)%variants)*size(sets(i)%links), i=1, size(sets))])
      if (n == 0) n = merge(processor_count(), 1, work > least_work)
      if (options%check .or. allocated(options%files(out_svg)%text) .or. &
         allocated(options%files(out_animation)%text) .or. allocated(options%files(out_circuits)%text)) n = 1
      n = max(1, min(n, variants_before(sets, size(sets) + 1)))
   end function process_count

   !> The remarks about `sets`, each line ended by new_line('a'), for where they stand in no listing; '' for --quiet.
   function said_of(options, sets) result(text)
      type(options_t), intent(in) :: options
      type(mechanism_t), intent(in) :: sets(:)
      character(:), allocatable :: text
      integer :: i

      text = ''
      if (options%quiet) return
      do i = 1, size(sets)
         if (allocated(sets(i)%remarks)) text = text//remarks_text(sets(i))//new_line('a')
      end do
   end function said_of

   !> A run that a signal has ended ends by that signal; so does one whose reader has gone (kinmat DECK | head), and
   !> without a word, unless other outputs were asked for, which end there too.
   subroutine look_at_signals(o, status, message)
      type(writers_t), intent(in) :: o
      integer, intent(inout) :: status
      character(:), allocatable, intent(inout) :: message

      if (signal_received() > 0) then
         status = status_signal + signal_received()
      else if (broken_pipe_kills() .and. is_broken_pipe(o)) then
         status = status_signal + signal_pipe
         if (count(o%asked) == 1) message = ''
      end if
   end subroutine look_at_signals

   !> The sets of this share, one after another: shares put together in their order are the whole.
   subroutine run_sets(options, sets, findings, o, status)
      type(options_t), intent(in) :: options
      type(writers_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: sets(o%first:)
      type(findings_t), intent(inout) :: findings(o%first:)
      integer, intent(inout) :: status
      type(diagrams_t), allocatable :: page(:)
      integer :: i, before, varied

      if (o%asked(out_csv) .and. options%share == 1 .and. o%own_first == 1) &
         call csv_head(o%files(out_csv, 0), options%errors, o%varies)
      if (o%asked(out_svg)) call picture_head(o%files(out_svg, 0))
      if (o%asked(out_svg) .or. o%asked(out_animation)) allocate (o%drawings(o%first:o%last))
      if (o%asked(out_animation)) call picture_head(o%files(out_animation, 0))
      if (o%asked(out_circuits)) call picture_head(o%files(out_circuits, 0))
      before = o%first - 1
      varied = 0
      ! Where no set has variants, those before the part at hand need not be passed over.
      if (.not. o%varies) before = o%own_first - 1
      do i = before + 1, o%last
         if (before >= o%own_last) exit
         if (sets(i)%variants > 0) varied = varied + 1
         associate (count => max(1, sets(i)%variants))
            if (before < o%own_last .and. before + count >= o%own_first) call run_set(options, sets(i), i, varied, &
               o%own_first - before, o%own_last - before, findings(i), o, status)
            before = before + count
         end associate
         if (is_over(o, i)) then
            if (before > o%own_last) then
               call break_off(o, sets(i), say_broken_variant, o%own_last - before + sets(i)%variants)
            else if (i < o%last) then
               call break_off(o, sets(i), say_broken_set, sets(i)%set_number)
            end if
            exit
         end if
         if (o%asked(out_svg) .or. o%asked(out_animation)) &
            call draw_set(sets(i), size(o%drawings), o%drawings(i), o%progress)
         if (o%asked(out_circuits) .and. sets(i)%circuits) call draw_circuits(sets(i), page)
      end do
      ! Sets that were broken off are not drawn.
      if (o%asked(out_svg)) call put_pictures(o%files(out_svg, 0), o%drawings(o%first:i - 1))
      if (o%asked(out_animation)) &
         call put_animations(o%files(out_animation, 0), o%drawings(o%first:i - 1))
      if (o%asked(out_circuits)) call put_circuit_page(o%files(out_circuits, 0), page)
   end subroutine run_sets

   !> Records the drawing `d` of the film of `m`, one of so many `sets` on a page. It has an analysis of its own: a
   !> picture shows links that no table asks for, and what is printed must not depend on it.
   subroutine draw_set(m, sets, d, progress)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: sets
      type(drawing_t), intent(out) :: d
      type(progress_t), intent(inout) :: progress
      type(mechanism_t) :: film
      type(set_analysis_t) :: a
      integer :: every, k

      call film_of(m, sets, film, every)
      d = new_drawing(film, every)
      call make_set_analysis(with_all_links(film), a)
      do k = 0, instant_count(film) - 1
         ! The first of the instants of AT, from which the deck's own motion goes on.
         if (every == 0 .and. k == film%steps + 1) call make_set_analysis(with_all_links(m), a)
         call advance_set(a, instant(film, k))
         call record_instant(d, a%now, k)
         if (progress%shown) call show_progress(progress, 'PICTURE OF SET '//whole(m%set_number)//': INSTANT', k, &
            instant_count(film) - 1)
         if (signal_received() > 0) return
      end do
      if (m%assemblies) call make_set_analysis(m, a)
      if (m%assemblies) call draw_assemblies(a, d)
   end subroutine draw_set

   !> Adds the circuits of `m` to `page`. As a picture it has an analysis of its own.
   subroutine draw_circuits(m, page)
      type(mechanism_t), intent(in) :: m
      type(diagrams_t), allocatable, intent(inout) :: page(:)
      type(set_analysis_t) :: a
      type(circuits_t), allocatable :: found(:)

      call make_set_analysis(m, a)
      call advance_set(a, instant(m, 0))
      call find_all_circuits(a, found)
      call add_to_page(page, m, a, found)
   end subroutine draw_circuits

   !> Solves and writes set number `i`, `m`: of its variants those from `first` to `last`, as far as it has them.
   !> `varied`: how many sets have VARY cards up to this one.
   subroutine run_set(options, m, i, varied, first, last, findings, o, status)
      type(options_t), intent(in) :: options
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i, varied, first, last
      type(findings_t), intent(inout) :: findings
      type(writers_t), intent(inout) :: o
      integer, intent(inout) :: status
      type(variant_row_t) :: counts
      type(set_analysis_t) :: a
      type(answers_t) :: asked

      call new_set_motion(m, a%now, findings)
      if (first <= 1) call write_heads(options, m, a%now, i, findings, o)
      if (options%check) return
      if (m%variants == 0) then
         call run_motion(options, a, i, findings, .true., o, counts, asked)
         if (counts%flagged + counts%unproved > 0) status = status_flagged
      else
         call run_variants(options, a%now, i, max(1, first), min(m%variants, last), o%variations(varied), o, status)
      end if
   end subroutine run_set

   !> Writes what stands before the first instant of set number `i`, `m`, divided `s`.
   subroutine write_heads(options, m, s, i, findings, o)
      type(options_t), intent(in) :: options
      type(mechanism_t), intent(in) :: m
      class(set_t), intent(in) :: s
      integer, intent(in) :: i
      type(findings_t), intent(inout) :: findings
      type(writers_t), intent(inout) :: o

      if (o%asked(out_listing)) then
         o%layout = new_layout(s)
         call find_groups(m, findings)
         call listing_head(o%files(out_listing, 0), m, findings)
      end if
      if (options%check) return
      if (o%asked(out_log) .and. m%variants == 0) call log_head(o%files(out_log, 0), m, options%errors)
      if (o%asked(out_table) .or. o%asked(out_plot_table)) o%table = new_table(s)
      if (o%asked(out_table)) call table_head(o%files(out_table, i), o%table)
      if (o%asked(out_plot_table)) call table_head(o%files(out_plot_table, i), o%table)
      if (o%asked(out_plot_script)) &
         call put_script(o%files(out_plot_script, i), m, o%table, set_suffix(o%first, o%last, i))
      call flush_outputs(o, i)
   end subroutine write_heads

end module job
