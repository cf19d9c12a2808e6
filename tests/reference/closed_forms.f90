!> Tests. The closed form of each deck in input/, chosen by the deck's base name, and what the listing says of its
!> structure, counted by hand.
module closed_forms
   use structure, only: structure_report_t
   use quad_jet, only: qp
   use closed_forms_dyads, only: body_t
   use closed_forms_linkages, only: four_bar, crank_rockers, drawing, rise_dwell, drag_link, peaucellier, five_bar, pantograph, &
      book_four_bar
   use closed_forms_sliders, only: yoke, crank_slider, drawn_slider, drawn_cylinder, scotch_yoke, whitworth, &
      crank_shaper, cylinder, &
      trammel
   use closed_forms_legs, only: andrews, jansen
   use closed_forms_sixbars, only: watt, watt_output, stephenson, stephenson_output, klann, grounds
   use closed_forms_robots, only: three_rrr, three_rrr_cranks, excavator, xy_table, scissor
   use closed_forms_bars, only: chebyshev, kite, antiparallelogram, hart, two_loops
   use closed_forms_slides, only: crank_inline, inverted_slider, oldham, geneva, points_meet
   use closed_forms_ratios, only: ratio_laws, by_drives
   use closed_forms_overconstrained, only: parallel_cranks, double_parallelogram, two_guides, cognates, dixon
   use closed_forms_assemblies, only: platform_assemblies, platform, triple_rocker
   use closed_forms_branches, only: parallelogram_branch, antiparallelogram_branch, kite_branch, scott_russell_branch
   use closed_forms_published, only: ten_plates, teaching_four_bar, watt_i
   use hand_tolerances, only: tolerant_links
   use closed_forms_hard, only: parallelogram, scott_russell, near_equal_rod, dead_point, far_small, many_turns
   implicit none
   private
   public :: closed_form, hand_count

   !> Counts of a mechanism made by eye from the drawing in its deck.
   type :: count_t
      character(24) :: deck
      integer :: links, revolute, prismatic, drives   !< links with the ground
      integer :: ground = 1
      integer :: redundant = 0                        !< pairs' equations that the others already hold
      integer :: blocks = 0                           !< of slots: no link and no revolute pair of the tables
   end type count_t

   type(count_t), parameter :: counts(*) = [ &
      count_t('book_four_bar', 4, 4, 0, 1), count_t('geneva_slot', 3, 2, 1, 1, blocks=1), &
      count_t('crank_shaper', 5, 4, 2, 1, blocks=1), count_t('landing_gear', 6, 6, 1, 1), &
      count_t('yoke', 6, 5, 2, 1), count_t('jarzmowy', 6, 5, 2, 1), count_t('yoke_mirrored', 6, 5, 2, 1), &
      count_t('four_bar', 4, 4, 0, 1), count_t('stroke', 4, 4, 0, 1), &
      count_t('crank_rockers', 4, 4, 0, 1), &
      count_t('tolerances', 4, 4, 0, 1), count_t('guide_tolerances', 4, 3, 1, 1), &
      count_t('poles', 4, 4, 0, 1), count_t('cardan', 4, 2, 2, 1), count_t('rise_dwell', 4, 4, 0, 1), &
      count_t('transmission', 4, 4, 0, 1), count_t('geneva', 4, 3, 1, 1), count_t('points_meet', 3, 0, 2, 2), &
      count_t('boom', 4, 3, 1, 1), count_t('leverage', 2, 1, 0, 1), count_t('jacobian', 3, 2, 0, 2), &
      count_t('drawing', 4, 4, 0, 1), count_t('drawn_slider', 4, 3, 1, 1), count_t('drawn_cylinder', 4, 3, 1, 1), &
      count_t('crank_slider', 4, 3, 1, 1), count_t('scotch_yoke', 4, 2, 2, 1), count_t('whitworth', 6, 5, 2, 1), &
      count_t('drag_link', 4, 4, 0, 1), count_t('cylinder', 4, 3, 1, 1), count_t('trammel', 4, 2, 2, 1), &
      count_t('peaucellier', 8, 10, 0, 1), count_t('five_bar', 5, 5, 0, 2), count_t('pantograph', 5, 5, 0, 2), &
      count_t('andrews', 8, 10, 0, 1), count_t('jansen', 8, 10, 0, 1), count_t('watt', 6, 7, 0, 1), &
      count_t('stephenson', 6, 7, 0, 1), &
      count_t('watt_output', 6, 7, 0, 1), count_t('stephenson_output', 6, 7, 0, 1), count_t('three_rrr_cranks', 8, 9, &
      0, 3), &
      count_t('klann', 6, 7, 0, 1), count_t('grounds', 8, 6, 1, 1, ground=3), &
      count_t('three_rrr', 8, 9, 0, 3), count_t('excavator', 12, 12, 3, 3), count_t('xy_table', 4, 1, 2, 3), &
      count_t('scissor', 10, 11, 2, 1), count_t('chebyshev', 4, 4, 0, 1), count_t('kite', 4, 4, 0, 1), &
      count_t('antiparallelogram', 4, 4, 0, 1), count_t('hart', 6, 7, 0, 1), count_t('two_loops', 7, 7, 1, 2), &
      count_t('crank_inline', 4, 3, 1, 1), count_t('inverted_slider', 4, 3, 1, 1), count_t('oldham', 4, 2, 2, 1), &
      count_t('parallel_cranks', 5, 6, 0, 1, redundant=1), count_t('double_parallelogram', 5, 6, 0, 1, redundant=1), &
      count_t('two_guides', 4, 3, 2, 1, redundant=2), count_t('cognates', 10, 14, 0, 1, redundant=2), &
      count_t('dixon', 9, 12, 0, 1, redundant=1), &
      count_t('parallelogram_branch', 4, 4, 0, 1), count_t('antiparallelogram_branch', 4, 4, 0, 1), &
      count_t('kite_branch', 4, 4, 0, 1), count_t('scott_russell_branch', 4, 3, 1, 1), &
      count_t('parallelogram', 4, 4, 0, 1), count_t('parallelogram_at', 4, 4, 0, 1), &
      count_t('antiparallelogram_across', 4, 4, 0, 1), count_t('antiparallelogram_at', 4, 4, 0, 1), &
      count_t('kite_across', 4, 4, 0, 1), count_t('kite_at', 4, 4, 0, 1), &
      count_t('scott_russell', 4, 3, 1, 1), count_t('scott_russell_at', 4, 3, 1, 1), &
      count_t('near_equal_rod', 4, 3, 1, 1), count_t('dead_point_6', 4, 3, 1, 1), &
      count_t('dead_point_9', 4, 3, 1, 1), count_t('dead_point_12', 4, 3, 1, 1), &
      count_t('far_small', 4, 4, 0, 1), count_t('many_turns', 4, 4, 0, 1), &
      count_t('ten_plates', 11, 12, 2, 2), count_t('teaching_four_bar', 4, 4, 0, 1), count_t('watt_i', 6, 7, 0, 1), &
      count_t('platform', 5, 6, 0, 0), count_t('triple_rocker', 4, 4, 0, 1)]

contains

   !> The links of the mechanism `name` at the time `t`, in its set number `set`, or in that variant of its only set; none for an unknown name.
   !> The angles are on any branch: whoever asks brings them to the branch wanted.
   pure function closed_form(name, set, t) result(links)
      character(*), intent(in) :: name
      integer, intent(in) :: set
      real(qp), intent(in) :: t
      type(body_t), allocatable :: links(:)

      select case (name)
      case ('yoke', 'jarzmowy'); links = yoke(set, t, 1.0_qp)
      case ('yoke_mirrored'); links = yoke(set, t, -1.0_qp)
      case ('four_bar', 'stroke'); links = four_bar(set, t)
      case ('crank_rockers'); links = crank_rockers(set, t)
      case ('tolerances'); links = tolerant_links(1, t)
      case ('guide_tolerances'); links = tolerant_links(2, t)
      case ('landing_gear'); links = tolerant_links(3, t)
      case ('poles')
         links = four_bar(1, t)
         if (set == 2) links = parallelogram(t)
      case ('rise_dwell'); links = rise_dwell(set, t)
      case ('drawing'); links = drawing(set, t)
      case ('crank_slider'); links = crank_slider(set, t)
      case ('drawn_slider'); links = drawn_slider(set, t)
      case ('drawn_cylinder'); links = drawn_cylinder(t)
      case ('scotch_yoke'); links = scotch_yoke(set, t)
      case ('whitworth'); links = whitworth(t)
      case ('drag_link'); links = drag_link(set, t)
      case ('cylinder'); links = cylinder(t)
      case ('trammel', 'cardan'); links = trammel(set, t)
      case ('peaucellier'); links = peaucellier(t)
      case ('five_bar'); links = five_bar(t)
      case ('pantograph'); links = pantograph(set, t)
      case ('andrews'); links = andrews(set, t)
      case ('jansen'); links = jansen(t)
      case ('watt'); links = watt(t)
      case ('stephenson'); links = stephenson(t)
      case ('klann'); links = klann(t)
      case ('grounds'); links = grounds(t)
      case ('three_rrr'); links = three_rrr(t)
      case ('excavator'); links = excavator(t)
      case ('xy_table'); links = xy_table(t)
      case ('scissor'); links = scissor(t)
      case ('chebyshev'); links = chebyshev(t)
      case ('kite', 'kite_across', 'kite_at'); links = kite(t)
      case ('antiparallelogram', 'antiparallelogram_across', 'antiparallelogram_at'); links = antiparallelogram(t)
      case ('hart'); links = hart(t)
      case ('two_loops'); links = two_loops(t)
      case ('crank_inline'); links = crank_inline(t)
      case ('inverted_slider'); links = inverted_slider(t)
      case ('oldham'); links = oldham(t)
      case ('transmission'); links = drawing(1, t)
      case ('geneva'); links = geneva(t)
      case ('geneva_slot')
         links = geneva(t)
         links(4)%name = ''
      case ('crank_shaper'); links = crank_shaper(t)
      case ('book_four_bar'); links = book_four_bar(t)
      case ('points_meet'); links = points_meet(t)
      case ('boom', 'leverage', 'jacobian'); links = by_drives(name, ratio_laws(name, t))
      case ('parallel_cranks'); links = parallel_cranks(t)
      case ('double_parallelogram'); links = double_parallelogram(t)
      case ('two_guides'); links = two_guides(t)
      case ('cognates'); links = cognates(t)
      case ('dixon'); links = dixon(t)
      case ('parallelogram', 'parallelogram_at'); links = parallelogram(t)
      case ('scott_russell', 'scott_russell_at'); links = scott_russell(t)
      case ('parallelogram_branch'); links = parallelogram_branch(t)
      case ('antiparallelogram_branch'); links = antiparallelogram_branch(t)
      case ('kite_branch'); links = kite_branch(t)
      case ('scott_russell_branch'); links = scott_russell_branch(t)
      case ('near_equal_rod'); links = near_equal_rod(t)
      case ('dead_point_6'); links = dead_point(6, t)
      case ('dead_point_9'); links = dead_point(9, t)
      case ('dead_point_12'); links = dead_point(12, t)
      case ('far_small'); links = far_small(t)
      case ('many_turns'); links = many_turns(t)
      case ('watt_output'); links = watt_output(t)
      case ('stephenson_output'); links = stephenson_output(t)
      case ('three_rrr_cranks'); links = three_rrr_cranks(t)
      case ('ten_plates'); links = ten_plates(t)
      case ('teaching_four_bar'); links = teaching_four_bar(t)
      case ('watt_i'); links = watt_i(set, t)
      case ('platform')
         ! Of its assemblies that with the angle nearest to 60 deg.
         associate (all => platform_assemblies())
            links = platform(all(:, minloc(abs(all(3, :) - 1.05_qp), dim=1)))
         end associate
      case ('triple_rocker'); links = triple_rocker(t, 1.0_qp)
      case default; allocate (links(0))
      end select
   end function closed_form

   !> What the listing must say of the structure of the mechanism `name`: every link with three coordinates, two
   !> equations for every pair and three for every ground link.
   pure function hand_count(name) result(f)
      character(*), intent(in) :: name
      type(structure_report_t) :: f
      integer :: i

      do i = 1, size(counts)
         if (counts(i)%deck /= name) cycle
         f%links = counts(i)%links
         f%ground = counts(i)%ground
         f%revolute = counts(i)%revolute
         f%prismatic = counts(i)%prismatic
         f%drives = counts(i)%drives
         f%coordinates = 3*(f%links + counts(i)%blocks)
         f%equations = 2*(f%revolute + f%prismatic + counts(i)%blocks) + 3*f%ground
         ! In every one of these mechanisms the freedoms are driven one by one; (13) counts each equation.
         f%degrees_of_freedom = f%drives - counts(i)%redundant
      end do
   end function hand_count
end module closed_forms
